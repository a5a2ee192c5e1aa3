#pragma once

#include <optional>

#include <busbar/core/data_value.hpp>
#include <busbar/core/deadband.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>
#include <busbar/types/filter.hpp>

namespace busbar::server::detail {

/// A DataChangeFilter (Part 4, 7.22.2) that is ready to be applied to Values: decides what counts
/// as a change.
class ChangeFilter {
public:
    /// The default without a filter: a change of status or value.
    ChangeFilter() = default;
    /// Returns the filter for a Variable's Value. Bad_MonitoredItemFilterInvalid if it is not a
    /// filter or contradicts itself, Bad_FilterNotAllowed for an EventFilter or a deadband for a
    /// value that is not a number, Bad_MonitoredItemFilterUnsupported for an AggregateFilter, and
    /// Bad_DeadbandFilterInvalid for a deadband that is negative, past 100 % or a percentage
    /// without an `eu_range` (Part 8, 7.2).
    [[nodiscard]] static Result<ChangeFilter> make(const ExtensionObject& filter,
                                                   const model::AddressSpace& space,
                                                   model::NodeIndex variable,
                                                   const std::optional<Range>& eu_range);
    /// True for a deadband in percent, which needs the EURange.
    [[nodiscard]] static bool is_percentage(const ExtensionObject& filter);

    /// True if the new value, which is `value` with the other fields of `data`, must be reported
    /// after the last reported one.
    [[nodiscard]] bool passes(const DataValue& last, const DataValue& data, const Variant& value,
                              StatusCode status) const
    {
        if (is_other_status(last.status, status)) {
            return true;
        }
        if (trigger_ == DataChangeTrigger::Status) {
            return false;
        }
        if (trigger_ == DataChangeTrigger::StatusValueTimestamp &&
            (last.source_timestamp != data.source_timestamp ||
             last.source_picoseconds != data.source_picoseconds)) {
            return true;
        }
        return has_deadband_ ? is_past_deadband(last.value, value, deadband_)
                             : !(last.value == value);
    }
    /// False if equal values never pass, whatever their timestamps are.
    [[nodiscard]] bool looks_at_time() const
    {
        return trigger_ == DataChangeTrigger::StatusValueTimestamp;
    }

private:
    /// The bits that a queue sets do not count as a change.
    [[nodiscard]] static bool is_other_status(StatusCode a, StatusCode b);

    DataChangeTrigger trigger_{DataChangeTrigger::StatusValue};
    bool has_deadband_{false};
    /// In the value's own unit.
    double deadband_{0};
};

} // namespace busbar::server::detail
