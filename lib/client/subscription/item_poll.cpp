#include "item_poll.hpp"

#include <busbar/core/deadband.hpp>
#include <busbar/types/filter.hpp>

#include "item_table.hpp"

namespace busbar::client::detail {

bool is_change(const ItemParameters& parameters, const DataValue& last, const DataValue& value)
{
    DataChangeFilter filter;
    filter.trigger = DataChangeTrigger::StatusValue;
    if (const auto* given = parameters.filter.get_if<DataChangeFilter>()) {
        filter = *given;
    }
    if (last.status != value.status) {
        return true;
    }
    if (filter.trigger == DataChangeTrigger::Status) {
        return false;
    }
    if (filter.trigger == DataChangeTrigger::StatusValueTimestamp &&
        last.source_timestamp != value.source_timestamp) {
        return true;
    }
    const bool has_deadband =
        filter.deadband_type == static_cast<std::uint32_t>(DeadbandType::Absolute) &&
        filter.deadband_value >= 0;
    return has_deadband ? is_past_deadband(last.value, value.value, filter.deadband_value)
                        : !(last.value == value.value);
}

} // namespace busbar::client::detail
