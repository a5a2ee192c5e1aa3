#include <busbar/server/image_layout.hpp>

#include <algorithm>

#include <busbar/core/numeric_range.hpp>

#include "image_types.hpp"

namespace busbar::server {

namespace {

constexpr std::size_t alignment = 8;

std::size_t align(std::size_t offset)
{
    return (offset + alignment - 1) / alignment * alignment;
}

/// The bytes of one element, 0 for a type that an image cannot have; of a text they may be more
/// than there can be.
std::uint64_t stride_of(const ImageVariable& variable)
{
    return detail::visit_image_type(
        variable.type,
        [&](auto tag) -> std::uint64_t {
            using T = typename decltype(tag)::type;
            if constexpr (detail::is_image_text<T>) {
                constexpr std::uint64_t unit = alignof(detail::ImageText);
                const std::uint64_t bytes = sizeof(detail::ImageText) + variable.capacity;
                return (bytes + unit - 1) / unit * unit;
            } else {
                return sizeof(T);
            }
        },
        [] { return std::uint64_t{0}; });
}

/// The number of elements, 0 if the image's limit is passed.
std::uint64_t count_of(std::span<const std::uint32_t> dimensions)
{
    std::uint64_t count = 1;
    for (const std::uint32_t dimension : dimensions) {
        count *= dimension;
        if (count > ImageLayout::max_bytes) {
            return 0;
        }
    }
    return count;
}

} // namespace

Result<std::uint32_t> ImageLayout::add(const ImageVariable& variable)
{
    const std::uint64_t stride = stride_of(variable);
    if (stride == 0) {
        return fail(status::Bad_DataTypeIdUnknown);
    }
    if (variable.dimensions.size() > NumericRange::max_dimensions ||
        std::ranges::find(variable.dimensions, 0U) != variable.dimensions.end()) {
        return fail(status::Bad_OutOfRange);
    }
    const std::uint64_t count = count_of(variable.dimensions);
    const std::size_t left = max_bytes - plain_bytes_ - array_bytes_;
    if (count == 0 || count > (left - std::min(left, alignment)) / stride ||
        places_.size() == max_variables) {
        return fail(status::Bad_OutOfMemory);
    }
    ImagePlace place;
    place.type = variable.type;
    place.stride = static_cast<std::uint32_t>(stride);
    place.elements = static_cast<std::uint32_t>(count);
    place.dimensions = variable.dimensions;
    place.capacity = place.is_text() ? variable.capacity : 0;
    place.in_arrays = place.is_array() && !place.is_text();
    if (place.in_arrays) {
        place.array = array_count_++;
    }
    // Scalars lie side by side at their own alignment: what a scan copies stays small.
    std::size_t& end = place.in_arrays ? array_bytes_ : plain_bytes_;
    const auto unit =
        static_cast<std::size_t>(std::min<std::uint64_t>(stride & (~stride + 1), alignment));
    const std::size_t start = place.in_arrays ? align(end) : (end + unit - 1) / unit * unit;
    place.offset = static_cast<std::uint32_t>(start);
    end = start + place.bytes();
    places_.push_back(std::move(place));
    return static_cast<std::uint32_t>(places_.size() - 1);
}

} // namespace busbar::server
