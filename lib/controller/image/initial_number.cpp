#include "initial_values.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "server/image/image_types.hpp"

namespace busbar::controller::detail {

namespace {

template <typename T, typename From>
std::optional<T> integer_as(From value)
{
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else if constexpr (std::same_as<T, bool>) {
        return value == 0 || value == 1 ? std::optional{value == 1} : std::nullopt;
    } else {
        return std::in_range<T>(value) ? std::optional{static_cast<T>(value)} : std::nullopt;
    }
}

template <typename T>
std::optional<T> double_as(double value)
{
    if constexpr (std::same_as<T, float>) {
        const bool is_finite = std::isfinite(value);
        return is_finite && std::abs(value) > std::numeric_limits<float>::max()
                   ? std::nullopt
                   : std::optional{static_cast<float>(value)};
    } else if constexpr (std::same_as<T, double>) {
        return value;
    } else {
        return std::nullopt;
    }
}

template <typename T>
std::optional<T> number_as(const Variant& value)
{
    if (const T* const same = value.get_if<T>()) {
        return *same;
    }
    if constexpr (std::is_arithmetic_v<T>) {
        if (const auto* const integer = value.get_if<std::int64_t>()) {
            return integer_as<T>(*integer);
        }
        if (const auto* const integer = value.get_if<std::uint64_t>()) {
            return integer_as<T>(*integer);
        }
        if (const double* const real = value.get_if<double>()) {
            return double_as<T>(*real);
        }
    }
    return std::nullopt;
}

/// Returns milliseconds as a whole number of a unit of which one has `units`.
Variant whole_duration(const Variant& value, double units)
{
    const double* const milliseconds = value.get_if<double>();
    constexpr double most = 9e18;
    return milliseconds != nullptr && std::abs(*milliseconds * units) < most
               ? Variant{std::int64_t{std::llround(*milliseconds * units)}}
               : Variant{value};
}

template <typename Convert>
Variant since_midnight(const Variant& value, Convert convert)
{
    constexpr std::int64_t ticks_per_day = 864'000'000'000;
    const DateTime* const time = value.get_if<DateTime>();
    return time != nullptr && time->ticks >= 0 && time->ticks < ticks_per_day
               ? Variant{std::int64_t{convert(time->ticks)}}
               : Variant{value};
}

} // namespace

bool put_initial_number(BuiltInType type, const Variant& value, std::byte* to)
{
    return server::detail::visit_image_type(
        type,
        [&](auto tag) {
            using T = typename decltype(tag)::type;
            if constexpr (server::detail::is_image_text<T>) {
                return false;
            } else {
                const std::optional<T> number = number_as<T>(value);
                if (number) {
                    std::memcpy(to, &*number, sizeof *number);
                }
                return number.has_value();
            }
        },
        [] { return false; });
}

namespace {

constexpr std::int64_t ticks_per_millisecond = 10'000;
constexpr std::int64_t nanoseconds_per_tick = 100;

} // namespace

Variant as_published(ElementaryType type, BuiltInType built_in, const Variant& value)
{
    const bool is_long = type == ElementaryType::Ltime || type == ElementaryType::LtimeOfDay;
    if ((type == ElementaryType::Time || is_long) && built_in == BuiltInType::Int64) {
        return whole_duration(value, is_long ? 1e6 : 1);
    }
    if (type == ElementaryType::TimeOfDay && built_in == BuiltInType::UInt32) {
        return since_midnight(value, [](auto ticks) { return ticks / ticks_per_millisecond; });
    }
    if (type == ElementaryType::LtimeOfDay && built_in == BuiltInType::UInt64) {
        return since_midnight(value, [](auto ticks) { return ticks * nanoseconds_per_tick; });
    }
    return Variant{value};
}

} // namespace busbar::controller::detail
