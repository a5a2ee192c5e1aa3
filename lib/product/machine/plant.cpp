#include "plant.hpp"

#include <functional>
#include <string>
#include <utility>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/controller/plc_methods.hpp>
#include <busbar/controller/plc_nodes.hpp>
#include <busbar/types/ids.hpp>

#include "product/configuration/toml_reader.hpp"
#include "product/model/models.hpp"

namespace busbar::product {

Plant::Plant(const ControllerConfig& config, Runtime& runtime)
    : config_{config}, runtime_{runtime}, plays_hardware_{config.machine.program != nullptr &&
                                                          config.machine.simulates_hardware &&
                                                          runtime.is_simulated()},
      medium_{runtime.medium()}
{
    if (!config.plc.programs.empty() && !runtime.is_simulated()) {
        throw ConfigError{"plc.program", "found one, which only a simulated PLC has"};
    }
    if (config.machine.program) {
        asked_ = config.machine.program;
        for (const auto& variable : asked_->program().variables) {
            memory_.push_back(runtime.memory_of(variable));
        }
    }
}

std::span<std::byte> Plant::memory_of(const controller::GlobalVariable& variable)
{
    const auto& asked = asked_->program().variables;
    const bool is_known = !std::less<>{}(&variable, asked.data()) &&
                          std::less<>{}(&variable, asked.data() + asked.size());
    return is_known ? memory_[static_cast<std::size_t>(&variable - asked.data())]
                    : runtime_.memory_of(variable);
}

void Plant::load()
{
    if (plc_ == nullptr) {
        return; // that of the labels
    }
    loaded_ = expect(runtime_.load(
        *plc_, config_.machine.program ? &config_.machine.program->program() : nullptr));
    plc_->use(*loaded_);
}

void Plant::publish(server::Server& server, SourceFiles& sources, LogSink& log,
                    const controller::MachineEventLog* machine_log,
                    std::function<void(HardwareEvent)> hardware)
{
    if (config_.labels.has_plc()) {
        load_models(server, config_, sources, log);
        return; // the PLC is a machine of its own, of which clients see what is mapped
    }
    if (config_.machine.program) {
        program_.emplace(config_);
    }
    server::ImageOptions image = config_.image;
    image.cycle = config_.scan;
    plc_ = program_
               ? program_->make_plc(server, [this](const auto& each) { return memory_of(each); })
               : expect(controller::Plc::create(config_.plc, image));
    if (machine_log != nullptr) {
        plc_->instructions().use(*machine_log);
    }
    source_.emplace(plc_->image());
    controller::PlcNodesOptions nodes;
    nodes.source = server.add_source(*source_);
    nodes.cycle = config_.scan;
    model::AddressSpace& space = server.address_space();
    const auto folder =
        program_ ? program_->publish(server, nodes.source, *machine_log)
                 : expect(controller::publish_variables(space, *plc_, nodes), "the variables");
    if (const auto status = space.find(NodeId{1, "Status"}); program_ && status != model::no_node) {
        expect(space.add_reference(folder, NodeId{0, id::Organizes}, status), "the status");
    }
    load_models(server, config_, sources, log);
    events_ = expect(controller::PlcEvents::create(space, folder, *plc_, server.event_queue()),
                     "the events");
    if (plays_hardware_) {
        expect(publish_hardware(space, folder, methods_, server.add_source(methods_), medium_,
                                std::move(hardware)),
               "the hardware");
    }
    if (!program_) {
        expect(controller::publish_methods(space, folder, *plc_, methods_,
                                           server.add_source(methods_)),
               "the methods");
    }
}

} // namespace busbar::product
