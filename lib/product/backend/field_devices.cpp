#include "field_devices.hpp"

#include <chrono>
#include <string>
#include <utility>

#include <busbar/model/data_access.hpp>
#include <busbar/model/units.hpp>
#include <busbar/types/ids.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

namespace {

using backend::DeviceFact;
using backend::DeviceSource;

constexpr const char* backends_uri = "urn:busbar:backends";

TimePoint now()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

Array<LocalizedText> state_names()
{
    Array<LocalizedText> all;
    for (const char* const text : {"Waiting", "Connecting", "Online"}) {
        all.push_back(LocalizedText{{}, String{text}});
    }
    return all;
}

Array<LocalizedText> mode_names()
{
    using enum backend::DeviceMode;
    Array<LocalizedText> all;
    for (const backend::DeviceMode mode : {Unknown, Run, Stop, Pause}) {
        all.push_back(LocalizedText{{}, String{name_of(mode)}});
    }
    return all;
}

/// Adds nodes of one backend; their NodeIds are "press.Speed".
class Nodes {
public:
    Nodes(model::AddressSpace& space, std::uint16_t namespace_index, const BackendConfig& config,
          const DeviceSource& source)
        : space_{space}, index_{namespace_index}, config_{config}, source_{source}
    {
    }

    void add()
    {
        model::NewNode folder;
        folder.id = NodeId{index_, String{config_.name}};
        folder.browse_name = QualifiedName{index_, String{config_.name}};
        folder.parent = space_.find(id::ObjectsFolder);
        folder_ = expect(space_.add_folder(folder), "the folder of " + config_.name);
        for (std::size_t i = 0; i < config_.variables.size(); ++i) {
            add_variable(config_.variables[i], i);
        }
        add_connection();
    }

private:
    [[nodiscard]] model::NewNode node(const std::string& name, model::NodeIndex parent,
                                      const std::string& path) const
    {
        model::NewNode made;
        made.id = NodeId{index_, String{config_.name + path}};
        made.browse_name = QualifiedName{index_, String{name}};
        made.parent = parent;
        return made;
    }
    void add_variable(const BackendVariable& variable, std::size_t handle)
    {
        model::NewNode made = node(variable.name, folder_, "." + variable.name);
        if (!variable.description.empty()) {
            made.description = LocalizedText{{}, String{variable.description}};
        }
        model::AnalogItem item;
        item.variable.data_type =
            NodeId{0, static_cast<std::uint32_t>(backend::data_type_of(variable.point))};
        item.variable.access_level =
            variable.point.is_writable ? model::Access::ReadWrite : model::Access::Read;
        item.variable.source = source_.index();
        item.variable.handle = handle;
        const auto& scale = variable.point.scale;
        if (!scale && variable.unit.empty()) {
            expect(space_.add_variable(made, item.variable), variable.name);
            return;
        }
        if (scale) {
            item.eu_range = Range{scale->low, scale->high};
        }
        if (!variable.unit.empty()) {
            item.engineering_units = model::engineering_units(variable.unit);
        }
        item.type = NodeId{0, !scale                  ? id::AnalogUnitType
                              : variable.unit.empty() ? id::AnalogItemType
                                                      : id::AnalogUnitRangeType};
        expect(model::add_analog_item(space_, made, item), variable.name);
    }
    void add_connection()
    {
        // Variables cannot be called so: their names have no blank.
        model::NewNode made = node("Connection", folder_, " Connection");
        made.reference_type = NodeId{0, id::HasComponent};
        const auto object = expect(space_.add_object(made), "the connection of " + config_.name);
        for (std::size_t i = 0; i < backend::device_facts; ++i) {
            const auto fact = static_cast<DeviceFact>(i);
            const std::string name = backend::name_of(fact);
            model::NewVariable variable;
            variable.data_type = NodeId{0, static_cast<std::uint32_t>(source_.fact(fact).type())};
            variable.source = source_.index();
            variable.handle = DeviceSource::status_handle(fact);
            const model::NewNode of = node(name, object, " Connection." + name);
            if (fact != DeviceFact::State && fact != DeviceFact::Mode) {
                expect(space_.add_variable(of, variable), name);
                continue;
            }
            model::MultiStateItem state;
            state.variable = variable;
            state.enum_strings = fact == DeviceFact::State ? state_names() : mode_names();
            expect(model::add_multi_state(space_, of, state), name);
        }
    }

    model::AddressSpace& space_;
    std::uint16_t index_;
    const BackendConfig& config_;
    const DeviceSource& source_;
    model::NodeIndex folder_{model::no_node};
};

} // namespace

FieldDevices::One::One(const BackendConfig& c, const WallClock& clock, LogSink& log)
    : config{c}, device{c.device, c.make_protocol(), log}, source{device, c.points(), clock, now,
                                                                  c.source}
{
}

FieldDevices::FieldDevices(const std::vector<BackendConfig>& configs, const WallClock& clock,
                           LogSink& log)
    : log_{log}
{
    for (const BackendConfig& config : configs) {
        all_.push_back(std::make_unique<One>(config, clock, log));
    }
}

FieldDevices::~FieldDevices() = default;

void FieldDevices::publish(server::Server& server)
{
    if (all_.empty()) {
        return;
    }
    const auto index =
        expect(server.address_space().add_namespace(backends_uri), "the namespace of backends");
    server.address_space().reserve(size());
    for (const auto& one : all_) {
        server.add_source(one->source);
        Nodes{server.address_space(), index, one->config, one->source}.add();
    }
}

void FieldDevices::start(net::ServerLoop& loop)
{
    for (const auto& one : all_) {
        one->driver = std::make_unique<net::DeviceDriver>(loop, one->device, log_);
    }
}

void FieldDevices::stop()
{
    for (const auto& one : all_) {
        one->driver.reset();
    }
}

std::size_t FieldDevices::size() const
{
    std::size_t sum = 0;
    for (const auto& one : all_) {
        sum += one->config.variables.size();
    }
    return sum;
}

} // namespace busbar::product
