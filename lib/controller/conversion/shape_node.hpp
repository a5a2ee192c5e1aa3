#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <busbar/controller/value_shape.hpp>
#include <busbar/core/types.hpp>

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

/// Good if `value` has the dimensions of the shape: none for a scalar.
[[nodiscard]] inline StatusCode check_dimensions(const ShapeNode& node, const Variant& value)
{
    const auto expected = node.dimensions();
    bool fits = value.is_array() == !expected.empty();
    if (expected.size() > 1) {
        const auto found = value.dimensions();
        fits = fits && std::equal(found.begin(), found.end(), expected.begin(), expected.end());
    } else if (expected.size() == 1) {
        fits = fits && !value.is_matrix() && value.array_size() == expected[0];
    }
    return fits ? status::Good : status::Bad_WriteNotSupported;
}

/// Makes an array or, with more dimensions, a matrix.
template <typename T>
[[nodiscard]] Variant shaped(const ShapeNode& node, Array<T> values)
{
    return node.form.rank < 2
               ? Variant{std::move(values)}
               : Variant::matrix(std::move(values), Array<std::uint32_t>{node.dimensions()});
}

/// Returns the step that a field adds to a path: ".Name". Escapes separators in the name by
/// backslashes, so that a field "A.B" is not taken for B of a field "A".
[[nodiscard]] inline std::string field_step(std::string_view name)
{
    std::string step{'.'};
    for (const char c : name) {
        if (c == '.' || c == '[' || c == ']' || c == '\\') {
            step += '\\';
        }
        step += c;
    }
    return step;
}

} // namespace busbar::controller::detail
