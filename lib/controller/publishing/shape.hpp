#pragma once

#include <cstdint>

#include <busbar/controller/program_types.hpp>
#include <busbar/core/array.hpp>

namespace busbar::controller::detail {

/// Returns the ValueRank (Part 3, 5.6.2).
[[nodiscard]] inline std::int32_t value_rank(const ResolvedType& type)
{
    return type.is_array() ? static_cast<std::int32_t>(type.dimensions.size()) : -1;
}

/// Returns the ArrayDimensions: the lengths, whatever the first index is; null if it is not an
/// array.
[[nodiscard]] inline Array<std::uint32_t> array_dimensions(const ResolvedType& type)
{
    Array<std::uint32_t> lengths;
    for (const Bounds& bounds : type.dimensions) {
        lengths.push_back(static_cast<std::uint32_t>(bounds.upper - bounds.lower + 1));
    }
    return lengths;
}

} // namespace busbar::controller::detail
