#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/value_shape.hpp>

#include "controller/conversion/shape_node.hpp"

namespace busbar::controller::detail {

/// Makes the nodes of one value.
class ShapeBuilder {
public:
    /// All arguments must outlive this object.
    ShapeBuilder(const model::SpaceReader& space, const binary::DynamicTypes& types,
                 std::span<const MappingArray> arrays, const ShapeLimits& limits);

    [[nodiscard]] Expected<ShapeNode, ShapeRefusal> build(const ValueDeclaration& declaration);
    /// The fields that got no leaves, with the reasons.
    [[nodiscard]] std::vector<ShapeRefusal> take_kept() { return std::move(kept_); }

private:
    using Node = Expected<ShapeNode, ShapeRefusal>;
    using Fields = Expected<ShapeNode::Fields, ShapeRefusal>;

    [[nodiscard]] Node value(const ValueDeclaration& declaration, const std::string& path,
                             std::size_t depth);
    [[nodiscard]] Node structure(ShapeNode node, const std::string& path, std::size_t depth);
    [[nodiscard]] Fields fields(const binary::DynamicType& type, const std::string& path,
                                std::size_t depth);
    [[nodiscard]] Node field(const binary::DynamicField& field, const std::string& path,
                             std::size_t depth);
    [[nodiscard]] const MappingArray* chosen(std::string_view path) const;
    /// Tells whether dimensions were chosen for single elements of an array.
    [[nodiscard]] bool has_choices_in(std::string_view array_path) const;

    const model::SpaceReader& space_;
    const binary::DynamicTypes& types_;
    /// Sorted by their paths.
    std::vector<const MappingArray*> arrays_;
    ShapeLimits limits_;
    bool is_argument_{false};
    std::size_t nodes_{0};
    std::vector<ShapeRefusal> kept_;
};

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
