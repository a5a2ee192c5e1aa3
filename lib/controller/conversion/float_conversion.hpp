#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include <busbar/core/status_code.hpp>
#include <busbar/core/status_codes.hpp>

/// The tables "Floating point conversion" (SH-082679, 8.2). Their borders are printed with seven
/// and fifteen digits; here they are the greatest and the least normal number of single and double
/// precision themselves, so that all of a type's numbers are in its range.
namespace busbar::controller::detail {

/// Reads a double as a single: smaller than the least normal single becomes a zero with the same
/// sign, beyond the greatest becomes infinite.
[[nodiscard]] inline float read_float(double value)
{
    using Limits = std::numeric_limits<float>;
    const double magnitude = std::fabs(value);
    if (magnitude > Limits::max()) {
        return std::copysign(Limits::infinity(), static_cast<float>(std::copysign(1.0, value)));
    }
    if (magnitude < Limits::min()) {
        return std::copysign(0.0F, static_cast<float>(std::copysign(1.0, value)));
    }
    return static_cast<float>(value);
}

[[nodiscard]] inline double read_float(float value)
{
    return std::fpclassify(value) == FP_SUBNORMAL ? std::copysign(0.0, double{value})
                                                  : double{value};
}

/// Good if a client may write `value` to a label of the same type: it must not be negative zero,
/// denormalized, infinite or NaN (note 1 of "Data types of labels").
template <typename T>
[[nodiscard]] StatusCode check_same(T value)
{
    const int kind = std::fpclassify(value);
    const bool is_positive_zero = kind == FP_ZERO && !std::signbit(value);
    return kind == FP_NORMAL || is_positive_zero ? status::Good : status::Bad_OutOfRange;
}

/// Writes to a label of the other precision: values that are too small become zero, and note 2
/// applies to the result, so that of these only positive ones can be written.
template <typename To, typename From>
[[nodiscard]] StatusCode write_float(From value, To& label)
{
    static_assert(!std::is_same_v<To, From>);
    if (std::isnan(value)) {
        return status::Bad_OutOfRange;
    }
    label = read_float(value);
    return check_same(label);
}

} // namespace busbar::controller::detail
