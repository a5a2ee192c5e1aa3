#pragma once

#include <cstdint>
#include <span>

#include <busbar/core/types.hpp>

namespace busbar::model::detail {

/// Replaces every namespace index of a value by `map[index]`; an index past the map stays.
///
/// Looks into Variants and DataValues, and into the structures of namespace 0 that are values of
/// most models: Argument and StructureDefinition. Bodies of other structures stay as they are.
void map_namespaces(Variant& value, std::span<const std::uint16_t> map);

} // namespace busbar::model::detail
