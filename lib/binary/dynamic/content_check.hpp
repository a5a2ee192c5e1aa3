#pragma once

#include <busbar/binary/dynamic_value.hpp>

/// Whether content fits a field: the rules that every DynamicValue keeps.
namespace busbar::binary::detail {

[[nodiscard]] bool fits(const DynamicField& field, const Variant& content);
[[nodiscard]] bool fits(const DynamicField& field, const DynamicValue& content);
[[nodiscard]] bool fits(const DynamicField& field, const DynamicArray& content);
/// True for a structure that a field which allows subtypes can hold as ExtensionObject.
[[nodiscard]] bool may_be_subtype(const DynamicField& field, const DynamicValue& content);

/// True if a scalar field of Variants may hold `content`.
[[nodiscard]] bool fits_variant(const DynamicField& field, const Variant& content);

} // namespace busbar::binary::detail
