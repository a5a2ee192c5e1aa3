#pragma once

#include <busbar/core/variant.hpp>
#include <busbar/model/space_reader.hpp>

#include "data_types.hpp"

namespace busbar::nodeset {

/// Gives a list the ArrayDimensions of its Variable if they are those of a matrix of as many
/// elements, which is how older tools write matrices. Otherwise returns the value as it is.
[[nodiscard]] Variant with_dimensions(const Variant& value,
                                      const model::VariableAttributes& attributes);

/// Converts a value that does not fit to the type and rank of its Variable, if nothing is lost:
/// numbers to a type that has the same number, a String to a LocalizedText and back, a scalar to
/// a list of one and back, a structure to a subtype that has no further fields, as all of OptionSet
/// are (Part 3, 8.40). Returns null if that is impossible.
[[nodiscard]] Variant converted(const model::SpaceReader& space, const DataTypeTable& types,
                                const Variant& value, const model::VariableAttributes& attributes);

} // namespace busbar::nodeset
