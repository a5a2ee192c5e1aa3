#pragma once

#include <cstddef>
#include <vector>

#include <busbar/controller/value_shape.hpp>

namespace busbar::controller::detail {

/// A value or a field of a structure: a scalar or an array.
struct ShapeNode {
    enum class Kind : std::uint8_t {
        Leaf,
        Structure,
        Kept, // a field without leaves
    };
    using Fields = std::vector<ShapeNode>;

    Kind kind{Kind::Leaf};
    /// The type of the leaves; ExtensionObject for structures.
    LeafType leaf{};
    ArrayForm form{};
    const binary::DynamicType* type{nullptr};
    /// Number of leaves in all elements together.
    std::size_t leaves{0};
    /// The fields of a structure, as many as its type has: one list for each element, or a single
    /// one if all elements are alike.
    std::vector<Fields> contents{};

    [[nodiscard]] const Fields& fields_of(std::size_t element) const
    {
        return contents[contents.size() == 1 ? 0 : element];
    }
    [[nodiscard]] std::span<const std::uint32_t> dimensions() const
    {
        return std::span{form.dimensions}.first(form.rank);
    }
};

[[nodiscard]] inline std::size_t leaves_of(const ShapeNode::Fields& fields)
{
    std::size_t sum = 0;
    for (const ShapeNode& field : fields) {
        sum += field.leaves;
    }
    return sum;
}

/// Writes the place of an element in row-major order: "[1][2]", or nothing for a scalar.
[[nodiscard]] std::string element_path(const ArrayForm& form, std::size_t element);

/// See ValueShape::assemble and take_apart.
[[nodiscard]] Result<Variant> assemble(const ShapeNode& root, const binary::DynamicTypes& types,
                                       const Variant* previous, ValueShape::Fill fill);
[[nodiscard]] StatusCode take_apart(const ShapeNode& root, const binary::DynamicTypes& types,
                                    const Variant& value, ValueShape::Take take);

} // namespace busbar::controller::detail
