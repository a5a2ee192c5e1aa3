#pragma once

#include <busbar/model/space_reader.hpp>

#include "data_types.hpp"

namespace busbar::nodeset {

/// Adds the DataTypes of an AddressSpace, as their attributes and references describe them.
void add_data_types(const model::SpaceReader& space, DataTypeTable& types);

/// The Definition that a DataTypeDefinition attribute stands for, with the fields of supertypes.
[[nodiscard]] std::optional<Definition> definition_from(const ExtensionObject& attribute);

} // namespace busbar::nodeset
