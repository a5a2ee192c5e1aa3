#pragma once

#include <busbar/core/types.hpp>

#include "data_types.hpp"

namespace busbar::nodeset {

/// The DataTypeDefinition attribute of a DataType (Part 3, 5.8.3): a StructureDefinition or an
/// EnumDefinition with a binary body; null if the DataType has none.
[[nodiscard]] ExtensionObject definition_of(const DataTypeTable& types, const DataType& type);

} // namespace busbar::nodeset
