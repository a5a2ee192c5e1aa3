#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <busbar/core/numeric_range.hpp>

namespace busbar::detail {

/// A box in a row-major array: per dimension its first index and its count.
struct Box {
    std::size_t rank{0};
    std::array<std::size_t, NumericRange::max_dimensions> size{};  // of the whole array
    std::array<std::size_t, NumericRange::max_dimensions> first{}; // of the box
    std::array<std::size_t, NumericRange::max_dimensions> count{}; // of the box

    [[nodiscard]] std::size_t elements() const
    {
        std::size_t product = 1;
        for (std::size_t i = 0; i < rank; ++i) {
            product *= count[i];
        }
        return product;
    }
};

/// Makes the box that `bounds` cuts out of an array of `size` elements with `dimensions` (none for
/// a vector), with its far ends limited to the array's. False if a first index is outside or the
/// ranks differ.
inline bool make_box(std::span<const NumericRange::Bounds> bounds, std::size_t size,
                     std::span<const std::uint32_t> dimensions, Box& box)
{
    box.rank = dimensions.empty() ? 1 : dimensions.size();
    if (bounds.size() != box.rank) {
        return false;
    }
    for (std::size_t i = 0; i < box.rank; ++i) {
        box.size[i] = dimensions.empty() ? size : dimensions[i];
        box.first[i] = bounds[i].first;
        if (box.first[i] >= box.size[i]) {
            return false;
        }
        box.count[i] = static_cast<std::size_t>(
            std::min<std::uint64_t>(bounds[i].count(), box.size[i] - box.first[i]));
    }
    return true;
}

/// Calls `visit(index)` with the flat index of each element in the box, in row-major order, until
/// it returns false.
template <typename Visit>
bool walk(const Box& box, Visit&& visit)
{
    std::array<std::size_t, NumericRange::max_dimensions> at{};
    for (std::size_t left = box.elements(); left != 0; --left) {
        std::size_t index = 0;
        for (std::size_t i = 0; i < box.rank; ++i) {
            index = index * box.size[i] + box.first[i] + at[i];
        }
        if (!visit(index)) {
            return false;
        }
        for (std::size_t i = box.rank; i-- != 0 && ++at[i] == box.count[i];) {
            at[i] = 0;
        }
    }
    return true;
}

} // namespace busbar::detail
