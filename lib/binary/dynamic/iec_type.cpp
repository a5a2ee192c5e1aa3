#include "iec_type.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/ascii_case.hpp"
#include "core/iec_time.hpp"

namespace busbar::binary::detail {

namespace {

constexpr std::int64_t millisecond = 1'000'000;
constexpr std::int64_t nanoseconds_per_day = 86'400'000 * millisecond;
constexpr std::int64_t nanoseconds_per_tick = 1'000'000'000 / DateTime::ticks_per_second;

struct IecName {
    std::string_view name;
    IecType type;
};
constexpr std::array names{
    IecName{"TIME", {IecKind::Duration, millisecond}},
    IecName{"LTIME", {IecKind::Duration, 1}},
    IecName{"TOD", {IecKind::TimeOfDay, millisecond}},
    IecName{"TIME_OF_DAY", {IecKind::TimeOfDay, millisecond}},
    IecName{"LTOD", {IecKind::TimeOfDay, 1}},
    IecName{"DATE", {IecKind::Date, millisecond}},
    IecName{"LDATE", {IecKind::Date, millisecond}},
    IecName{"DT", {IecKind::DateAndTime, millisecond}},
    IecName{"DATE_AND_TIME", {IecKind::DateAndTime, millisecond}},
    IecName{"LDT", {IecKind::DateAndTime, millisecond}},
};

/// Returns the part of a literal of this kind after its #, or all of a text without one; nothing
/// for a literal of another kind.
std::optional<std::string_view> body_of(IecKind kind, std::string_view text)
{
    const std::size_t hash = text.find('#');
    if (hash == std::string_view::npos) {
        return text;
    }
    const std::string_view prefix = text.substr(0, hash);
    const auto is_one = [&](std::string_view name) {
        return busbar::detail::is_same_ignoring_case(prefix, name);
    };
    const bool is_right = (kind == IecKind::Duration && (is_one("T") || is_one("LT"))) ||
                          (kind == IecKind::Date && (is_one("D") || is_one("LD"))) ||
                          std::any_of(names.begin(), names.end(), [&](const IecName& known) {
                              return known.type.kind == kind && is_one(known.name);
                          });
    return is_right ? std::optional{text.substr(hash + 1)} : std::nullopt;
}

} // namespace

std::optional<IecType> iec_type(const DynamicType* type)
{
    if (type == nullptr || type->kind != DynamicType::Kind::Simple) {
        return std::nullopt;
    }
    const auto* const found = std::find_if(
        names.begin(), names.end(), [&](const IecName& known) { return known.name == type->name; });
    return found == names.end() ? std::nullopt : std::optional{found->type};
}

std::string iec_text(const IecType& type, std::int64_t number)
{
    const bool fits =
        number >= INT64_MIN / type.nanoseconds && number <= INT64_MAX / type.nanoseconds;
    if (!fits) {
        return {};
    }
    const std::int64_t nanoseconds = number * type.nanoseconds;
    if (type.kind == IecKind::Duration) {
        return busbar::detail::duration_text(nanoseconds);
    }
    const bool is_in_day = nanoseconds >= 0 && nanoseconds < nanoseconds_per_day;
    return type.kind == IecKind::TimeOfDay && is_in_day
               ? busbar::detail::time_of_day_text(nanoseconds)
               : std::string{};
}

std::string iec_text(const IecType& type, DateTime time)
{
    switch (type.kind) {
    case IecKind::Date:
        return time.is_null() ? "" : busbar::detail::date_text(time);
    case IecKind::DateAndTime:
        return time.is_null() ? "" : busbar::detail::date_and_time_text(time);
    case IecKind::TimeOfDay: {
        constexpr std::int64_t per_day = 86'400 * DateTime::ticks_per_second;
        return time.ticks < 0
                   ? ""
                   : busbar::detail::time_of_day_text(time.ticks % per_day * nanoseconds_per_tick);
    }
    default:
        return {};
    }
}

std::optional<std::int64_t> iec_number(const IecType& type, std::string_view text)
{
    const auto body = body_of(type.kind, text);
    if (!body) {
        return std::nullopt;
    }
    if (type.kind == IecKind::TimeOfDay) {
        const auto time = busbar::detail::read_time_of_day(*body);
        return time ? std::optional{time->ticks * nanoseconds_per_tick / type.nanoseconds}
                    : std::nullopt;
    }
    const auto milliseconds = type.kind == IecKind::Duration ? busbar::detail::read_duration(*body)
                                                             : std::optional<double>{};
    const double number =
        milliseconds
            ? std::round(*milliseconds * (millisecond / static_cast<double>(type.nanoseconds)))
            : NAN;
    constexpr double most = 9e18;
    return std::abs(number) < most ? std::optional{static_cast<std::int64_t>(number)}
                                   : std::nullopt;
}

std::optional<DateTime> iec_time(const IecType& type, std::string_view text)
{
    const auto body = body_of(type.kind, text);
    if (!body) {
        return std::nullopt;
    }
    switch (type.kind) {
    case IecKind::Date:
        return busbar::detail::read_date(*body);
    case IecKind::DateAndTime:
        return busbar::detail::read_date_and_time(*body);
    case IecKind::TimeOfDay:
        return busbar::detail::read_time_of_day(*body);
    default:
        return std::nullopt;
    }
}

} // namespace busbar::binary::detail
