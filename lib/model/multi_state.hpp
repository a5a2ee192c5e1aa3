#pragma once

#include <busbar/core/variant.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::model::detail {

/// Returns the ValueAsText of the value: null for an array and for a value without text (Part 8,
/// 5.3.3.4).
[[nodiscard]] LocalizedText text_of(const Variant& value, const Array<EnumValueType>& enum_values);

} // namespace busbar::model::detail
