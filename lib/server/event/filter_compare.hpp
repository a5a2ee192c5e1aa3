#pragma once

#include <compare>
#include <optional>

#include <busbar/core/types.hpp>

/// Comparisons of a ContentFilter (Part 4, 7.7.3). Values of different types are converted to their
/// common type first.
namespace busbar::server::detail {

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
