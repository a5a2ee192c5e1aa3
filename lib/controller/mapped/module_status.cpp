#include <busbar/controller/module_status.hpp>

#include <algorithm>
#include <array>

namespace busbar::controller {

namespace {

struct Value {
    const char* name;
    std::uint64_t handle; // address in the buffer memory
    bool is_double;
};

constexpr std::uint64_t target_status = 8'448;
constexpr std::uint64_t label_update = 8'617;
constexpr std::uint64_t revised_interval = 12'419;
constexpr std::uint64_t actual_interval = 12'421;

constexpr std::array values{
    Value{"TargetDevice1Status", target_status, false},
    Value{"LabelUpdateRunningStatus", label_update, false},
    Value{"RevisedSamplingIntervalMinimum", revised_interval, true},
    Value{"ActualSamplingIntervalMinimum", actual_interval, true},
};

Variant milliseconds(Duration duration)
{
    const double all = std::min(to_milliseconds(duration), static_cast<double>(UINT32_MAX));
    return Variant{static_cast<std::uint32_t>(all)};
}

} // namespace

Variant ModuleStatus::value_of(std::uint64_t handle) const
{
    switch (handle) {
    case target_status:
        return Variant{static_cast<std::uint16_t>(source_->target_status())};
    case label_update:
        return Variant{static_cast<std::uint16_t>(source_->is_updating() ? 1 : 0)};
    case revised_interval:
        return milliseconds(server_->sampling_state().smallest_revised_interval);
    case actual_interval:
        return milliseconds(server_->sampling_state().smallest_actual_interval);
    default:
        return {};
    }
}

void ModuleStatus::read(server::ReadBatch batch)
{
    const DateTime now = clock_->now();
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (Variant value = value_of(batch.items()[i].handle); !value.is_null()) {
            batch.results()[i] = DataValue{std::move(value), status::Good, now};
        }
    }
    batch.complete();
}

Result<void> add_module_status_nodes(model::AddressSpace& space, model::NodeIndex parent,
                                     std::uint16_t namespace_index, const ModuleStatus& status)
{
    for (const Value& value : values) {
        const Variant like =
            value.is_double ? Variant{std::uint32_t{0}} : Variant{std::uint16_t{0}};
        const auto added = space.add_variable(parent, {namespace_index, value.name},
                                              status.variable(value.handle, like));
        if (!added) {
            return fail(added.error());
        }
    }
    return {};
}

} // namespace busbar::controller
