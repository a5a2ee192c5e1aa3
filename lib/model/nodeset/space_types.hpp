#pragma once

#include <busbar/model/space_reader.hpp>

#include "data_types.hpp"

namespace busbar::nodeset {

/// Adds the DataTypes of an AddressSpace by their attributes and references.
void add_data_types(const model::SpaceReader& space, DataTypeTable& types);

/// Returns the Definition for a DataTypeDefinition attribute, with the fields of supertypes.
[[nodiscard]] std::optional<Definition> definition_from(const ExtensionObject& attribute);

} // namespace busbar::nodeset
