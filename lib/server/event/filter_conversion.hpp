#pragma once

#include <cstdint>

#include <busbar/core/types.hpp>

/// Conversion of a ContentFilter's values to one type (Part 4, 7.7.3).
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

} // namespace busbar::server::detail
