#include "change_filter.hpp"

#include <algorithm>
#include <cmath>

#include <busbar/types/ids.hpp>

#include "value_queue.hpp"

namespace busbar::server::detail {

namespace {

Result<double> percent_of_range(const DataChangeFilter& filter, const std::optional<Range>& range)
{
    const double width = range ? range->high - range->low : -1;
    // Also rejects NaN.
    if (!(filter.deadband_value <= 100) || !(width >= 0)) {
        return fail(status::Bad_DeadbandFilterInvalid);
    }
    return filter.deadband_value / 100 * width;
}

StatusCode check(const DataChangeFilter& filter)
{
    const bool is_known = filter.trigger >= DataChangeTrigger::Status &&
                          filter.trigger <= DataChangeTrigger::StatusValueTimestamp &&
                          filter.deadband_type <= static_cast<std::uint32_t>(DeadbandType::Percent);
    return is_known ? status::Good : status::Bad_MonitoredItemFilterInvalid;
}

} // namespace

Result<ChangeFilter> ChangeFilter::make(const ExtensionObject& filter,
                                        const model::AddressSpace& space, model::NodeIndex variable,
                                        const std::optional<Range>& eu_range)
{
    ChangeFilter made;
    if (filter.is_null()) {
        return made;
    }
    if (filter.get_if<EventFilter>() != nullptr) {
        return fail(status::Bad_FilterNotAllowed);
    }
    if (filter.get_if<AggregateFilter>() != nullptr) {
        return fail(status::Bad_MonitoredItemFilterUnsupported);
    }
    const auto* change = filter.get_if<DataChangeFilter>();
    if (change == nullptr || check(*change).is_bad()) {
        return fail(status::Bad_MonitoredItemFilterInvalid);
    }
    made.trigger_ = change->trigger;
    const auto type = static_cast<DeadbandType>(change->deadband_type);
    if (type == DeadbandType::None) {
        return made;
    }
    if (!space.is_subtype_of(space.variable(variable).data_type, id::Number)) {
        return fail(status::Bad_FilterNotAllowed);
    }
    if (!(change->deadband_value >= 0)) {
        return fail(status::Bad_DeadbandFilterInvalid);
    }
    const Result<double> deadband = type == DeadbandType::Absolute
                                        ? Result<double>{change->deadband_value}
                                        : percent_of_range(*change, eu_range);
    if (!deadband) {
        return fail(deadband.error());
    }
    made.deadband_ = *deadband;
    made.has_deadband_ = true;
    return made;
}

bool ChangeFilter::is_percentage(const ExtensionObject& filter)
{
    const auto* const change = filter.get_if<DataChangeFilter>();
    return change != nullptr &&
           change->deadband_type == static_cast<std::uint32_t>(DeadbandType::Percent);
}

bool ChangeFilter::is_other_status(StatusCode a, StatusCode b)
{
    constexpr std::uint32_t own_bits = ValueQueue::overflow_bits |
                                       ValueQueue::structure_changed_bit |
                                       ValueQueue::semantics_changed_bit;
    return ((a.value() ^ b.value()) & ~own_bits) != 0;
}

} // namespace busbar::server::detail
