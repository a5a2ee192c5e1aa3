#pragma once

#include <algorithm>
#include <type_traits>

#include <busbar/core/types.hpp>

#include "controller/conversion/shape_node.hpp"

namespace busbar::controller::detail {

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

} // namespace busbar::controller::detail
