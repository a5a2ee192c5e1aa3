#include <busbar/server/image_layout.hpp>

#include <algorithm>

#include "image_shape.hpp"

namespace busbar::server {

namespace {

constexpr std::size_t block_alignment = 8;

} // namespace

Result<std::uint32_t> ImageLayout::add(const ImageVariable& variable)
{
    const std::size_t left = max_bytes - plain_bytes_ - array_bytes_;
    auto place = detail::shape_of(variable, left - std::min(left, block_alignment));
    if (!place) {
        return fail(place.error());
    }
    if (places_.size() == max_variables) {
        return fail(status::Bad_OutOfMemory);
    }
    place->in_arrays = place->is_array() && !place->is_text() && !place->is_structure();
    if (place->in_arrays) {
        place->array = array_count_++;
    }
    // Scalars lie side by side at their own alignment: what a scan copies stays small.
    std::size_t& end = place->in_arrays ? array_bytes_ : plain_bytes_;
    const std::size_t stride = place->stride;
    const std::size_t unit =
        place->in_arrays ? block_alignment : std::min(stride & (~stride + 1), block_alignment);
    const std::size_t start = detail::round_up(end, unit);
    place->offset = static_cast<std::uint32_t>(start);
    end = start + place->bytes();
    places_.push_back(std::move(*place));
    return static_cast<std::uint32_t>(places_.size() - 1);
}

} // namespace busbar::server
