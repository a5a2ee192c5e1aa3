#pragma once

#include <cstdint>

#include <busbar/core/types.hpp>

/// How the values of a ContentFilter are brought to one type (Part 4, 7.7.3).
namespace busbar::server::detail {

/// What a value of one type is to another.
enum class Conversion : char {
    None = '.',
    Same = '-',
    /// Done wherever types differ.
    Implicit = 'I',
    /// Done by the Cast operator only.
    Explicit = 'E',
};

/// Takes constant time, as all of these but the conversions themselves.
[[nodiscard]] Conversion conversion(BuiltInType from, BuiltInType to);

/// The type that values of both types are brought to before they are compared; Null if there is
/// none.
[[nodiscard]] BuiltInType common_type(BuiltInType a, BuiltInType b);

/// The value as one of the type; null if the types are not convertible that way or the value is
/// not. Arrays and matrices are converted element by element.
[[nodiscard]] Variant convert_implicitly(const Variant& value, BuiltInType to);
[[nodiscard]] Variant convert_explicitly(const Variant& value, BuiltInType to);

/// The only element of an array that has one, where a scalar is wanted; else `value`. What is
/// returned may lie in `storage`.
[[nodiscard]] const Variant& as_scalar(const Variant& value, Variant& storage);

} // namespace busbar::server::detail
