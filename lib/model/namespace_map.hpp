#pragma once

#include <cstdint>
#include <span>

#include <busbar/core/types.hpp>
#include <busbar/model/data_types.hpp>

namespace busbar::model::detail {

/// What structures are read by, whose NodeIds are those that the values have once they are mapped.
struct StructureTypes {
    const AddressSpace& space;
    DataTypes& types;
};

/// Replaces every namespace index of a value by `map[index]`; an index past the map stays.
///
/// Looks into Variants, DataValues and structures: Argument, RolePermissionType and
/// StructureDefinition always, others by `types`, which are compiled for the first of them only.
/// Without types, and if the definition is not known, their bodies stay as they are.
void map_namespaces(Variant& value, std::span<const std::uint16_t> map,
                    const StructureTypes* types = nullptr);

} // namespace busbar::model::detail
