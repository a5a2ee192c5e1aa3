#pragma once

#include <compare>
#include <optional>

#include <busbar/core/types.hpp>

/// Comparisons of a ContentFilter (Part 4, 7.7.3). Values of different types are brought to their
/// common type first.
namespace busbar::server::detail {

/// True for no value and for the null of its type (Part 6, 5.1.2), be it a scalar or an array.
[[nodiscard]] bool is_null_value(const Variant& value);

/// Nothing if one of them is no value; false for values that have no common type or cannot be
/// brought to it. Null and empty Strings, ByteStrings and arrays are equal, NaN is not.
[[nodiscard]] std::optional<bool> are_equal(const Variant& a, const Variant& b);

/// Unordered unless both are, or become, numbers or DateTimes.
[[nodiscard]] std::partial_ordering order(const Variant& a, const Variant& b);

/// True if `value` lies within the bounds, all three in one type.
[[nodiscard]] bool is_between(const Variant& value, const Variant& first, const Variant& last);

} // namespace busbar::server::detail
