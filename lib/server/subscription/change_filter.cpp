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
    // Also true of what is not a number.
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

template <typename T>
bool differs(T a, T b, double deadband)
{
    if constexpr (std::is_floating_point_v<T>) {
        const double distance = std::abs(static_cast<double>(a) - static_cast<double>(b));
        // What is not a number is as far as can be from any that is, and not from itself.
        return std::isnan(distance) ? !(a == b || (std::isnan(a) && std::isnan(b)))
                                    : distance > deadband;
    } else {
        const auto wide = [](T value) { return static_cast<std::uint64_t>(value); };
        return static_cast<double>(a > b ? wide(a) - wide(b) : wide(b) - wide(a)) > deadband;
    }
}

template <typename T>
std::optional<bool> differs_as(const Variant& a, const Variant& b, double deadband)
{
    if (const T* x = a.get_if<T>()) {
        const T* y = b.get_if<T>();
        return y == nullptr || differs(*x, *y, deadband);
    }
    const Array<T>* x = a.array_if<T>();
    if (x == nullptr) {
        return std::nullopt;
    }
    const Array<T>* y = b.array_if<T>();
    return y == nullptr || x->size() != y->size() ||
           !std::equal(x->begin(), x->end(), y->begin(),
                       [&](T p, T q) { return !differs(p, q, deadband); });
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

bool ChangeFilter::is_past_deadband(const Variant& last, const Variant& value) const
{
    std::optional<bool> result;
    // clang-format off
    switch (last.type()) {
    case BuiltInType::SByte: result = differs_as<std::int8_t>(last, value, deadband_); break;
    case BuiltInType::Byte: result = differs_as<std::uint8_t>(last, value, deadband_); break;
    case BuiltInType::Int16: result = differs_as<std::int16_t>(last, value, deadband_); break;
    case BuiltInType::UInt16: result = differs_as<std::uint16_t>(last, value, deadband_); break;
    case BuiltInType::Int32: result = differs_as<std::int32_t>(last, value, deadband_); break;
    case BuiltInType::UInt32: result = differs_as<std::uint32_t>(last, value, deadband_); break;
    case BuiltInType::Int64: result = differs_as<std::int64_t>(last, value, deadband_); break;
    case BuiltInType::UInt64: result = differs_as<std::uint64_t>(last, value, deadband_); break;
    case BuiltInType::Float: result = differs_as<float>(last, value, deadband_); break;
    case BuiltInType::Double: result = differs_as<double>(last, value, deadband_); break;
    default: break;
    }
    // clang-format on
    return result.value_or(!(last == value));
}

} // namespace busbar::server::detail
