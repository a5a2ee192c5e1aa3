#pragma once

#include <string>

#include <busbar/controller/value_shape.hpp>

namespace busbar::controller::detail {

/// The type that a DataType is mapped as: a leaf, or a structure with its type.
struct MappedType {
    LeafType leaf{};
    const binary::DynamicType* structure{nullptr};
};

/// Decides how a DataType is mapped by "Data types that can be assigned to other DataTypes" and
/// "Subtype handling" (SH-082679, 8.2). A refusal has no path.
[[nodiscard]] Expected<MappedType, ShapeRefusal>
use_of(const model::SpaceReader& space, const binary::DynamicTypes& types, const NodeId& data_type);

} // namespace busbar::controller::detail
