#pragma once

#include <compare>
#include <cstdint>
#include <optional>

#include <busbar/core/types.hpp>

/// Conversion of a ContentFilter's values to one type, and their comparison (Part 4, 7.7.3).

namespace busbar::server::detail {

/// The convertibility of one type to another.
enum class Conversion : char {
    None = '.',
    Same = '-',
    /// Performed wherever types differ.
    Implicit = 'I',
    /// Performed by the Cast operator only.
    Explicit = 'E',
};

/// Takes constant time, as all of these functions except the conversions themselves.
[[nodiscard]] Conversion conversion(BuiltInType from, BuiltInType to);

/// Returns the type that values of both types are converted to before they are compared; Null if
/// there is none.
[[nodiscard]] BuiltInType common_type(BuiltInType a, BuiltInType b);

/// Returns the value converted to the type; null if the types are not convertible in this way or
/// the value is not. Arrays and matrices are converted element by element.
[[nodiscard]] Variant convert_implicitly(const Variant& value, BuiltInType to);
[[nodiscard]] Variant convert_explicitly(const Variant& value, BuiltInType to);

/// Returns the only element of an array that has one, for use as a scalar; else `value`. The result
/// may be in `storage`.
[[nodiscard]] const Variant& as_scalar(const Variant& value, Variant& storage);

/// Returns the scalar converted to the type, whether the rules allow that or not; null if that is
/// impossible, because the number is too large or the text is not such a value (Part 4, 7.7.3).
[[nodiscard]] Variant convert_scalar(const Variant& value, BuiltInType to);

// Comparisons of a ContentFilter convert values of different types to their common type first.

/// True for no value and for the null of its type (Part 6, 5.1.2), as a scalar or an array.
[[nodiscard]] bool is_null_value(const Variant& value);

/// Returns nothing if one of them is not a value; false for values that have no common type or
/// cannot be converted to it. Null and empty Strings, ByteStrings and arrays are equal, NaN is not.
[[nodiscard]] std::optional<bool> are_equal(const Variant& a, const Variant& b);

/// Unordered unless both are, or are converted to, numbers or DateTimes.
[[nodiscard]] std::partial_ordering order(const Variant& a, const Variant& b);

/// True if `value` is within the bounds, with all three converted to one type.
[[nodiscard]] bool is_between(const Variant& value, const Variant& first, const Variant& last);

} // namespace busbar::server::detail
