#include "image_segments.hpp"

#include <algorithm>
#include <cstddef>

namespace busbar::server::detail {

namespace {

std::uint32_t end_of(const ImageSegment& segment)
{
    return segment.first + static_cast<std::uint32_t>(segment.layout.size());
}

} // namespace

std::uint32_t ImageSegments::size() const
{
    const std::uint32_t segments = count();
    return segments == 0 ? static_cast<std::uint32_t>(layout_->size())
                         : end_of(*segments_[segments - 1]);
}

std::uint32_t ImageSegments::segment_of(std::uint32_t handle) const
{
    // acquire, in count(): the pointers below, and their targets.
    const auto begin = segments_.begin();
    const auto after = std::upper_bound(
        begin, begin + static_cast<std::ptrdiff_t>(count()), handle,
        [](std::uint32_t sought, const auto& segment) { return sought < segment->first; });
    return static_cast<std::uint32_t>(after - begin) - 1;
}

const ImagePlace* ImageSegments::find(std::uint64_t handle) const
{
    if (handle < layout_->size()) {
        return &(*layout_)[static_cast<std::size_t>(handle)];
    }
    if (handle >= size()) {
        return nullptr;
    }
    const auto known = static_cast<std::uint32_t>(handle);
    const ImageSegment& segment = *segments_[segment_of(known)];
    return &segment.layout[known - segment.first];
}

std::size_t ImageSegments::bytes() const
{
    std::size_t sum = layout_->bytes();
    for (std::uint32_t i = 0; i < count(); ++i) {
        sum += segments_[i]->layout.bytes();
    }
    return sum;
}

void ImageSegments::add(std::unique_ptr<ImageSegment> segment)
{
    const std::uint32_t index = count();
    segments_[index] = std::move(segment);
    // release: code that reads the new count finds the segment in its present state.
    count_.store(index + 1, std::memory_order_release);
}

std::byte* ImageSegments::bytes_of(std::uint32_t handle) const
{
    if (handle < layout_->size()) {
        return memory_->bytes((*layout_)[handle]);
    }
    ImageSegment& segment = *segments_[segment_of(handle)];
    return segment.memory.bytes(segment.layout[handle - segment.first]);
}

} // namespace busbar::server::detail
