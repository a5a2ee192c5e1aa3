#include <busbar/server/image_layout.hpp>

#include <algorithm>
#include <cstdint>

#include "image_shape.hpp"

namespace busbar::server {

namespace {

constexpr std::size_t block_alignment = 8;

/// Returns whether the variable can stay in this memory.
bool can_lie_at(const ImagePlace& place, std::span<const std::byte> memory)
{
    return memory.size() == place.bytes() &&
           reinterpret_cast<std::uintptr_t>(memory.data()) % detail::alignment_of(place) == 0;
}

} // namespace

Result<std::uint32_t> ImageLayout::add(const ImageVariable& variable)
{
    const std::size_t left = max_bytes - bytes();
    auto place = detail::shape_of(variable, left - std::min(left, block_alignment));
    if (!place) {
        return fail(place.error());
    }
    if (places_.size() == max_variables) {
        return fail(status::Bad_OutOfMemory);
    }
    if (!variable.runtime.empty()) {
        if (!can_lie_at(*place, variable.runtime)) {
            return fail(status::Bad_InvalidArgument);
        }
        place->runtime = variable.runtime.data();
    }
    place->in_arrays = place->is_array() && !place->is_text() && !place->is_structure();
    if (place->in_arrays) {
        place->array = array_count_++;
    }
    // Scalars follow each other at their own alignment, so that a scan copies little.
    std::size_t& end = block_of(*place);
    const std::size_t stride = place->stride;
    const std::size_t unit =
        place->in_arrays ? block_alignment : std::min(stride & (~stride + 1), block_alignment);
    const std::size_t start = detail::round_up(end, unit);
    place->offset = static_cast<std::uint32_t>(start);
    end = start + place->bytes();
    places_.push_back(std::move(*place));
    return static_cast<std::uint32_t>(places_.size() - 1);
}

std::size_t& ImageLayout::block_of(const ImagePlace& place)
{
    if (place.runtime != nullptr) {
        return place.in_arrays ? runtime_array_bytes_ : gathered_bytes_;
    }
    return place.in_arrays ? array_bytes_ : plain_bytes_;
}

} // namespace busbar::server
