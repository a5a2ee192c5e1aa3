#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/server/image_memory.hpp>

#include "image_copy.hpp"

namespace busbar::server::detail {

/// Variables that were added to an image together: all that the task and its readers need for them.
struct ImageSegment {
    ImageSegment(ImageLayout added, std::uint32_t first_handle)
        : layout{std::move(added)}, memory{layout}, first{first_handle}
    {
    }

    ImageLayout layout;
    /// The task's.
    ImageMemory memory;
    /// The handle of the first of them.
    std::uint32_t first;
    /// For each buffer of the pool what it has of them.
    std::vector<ImageCopy> copies;
};

/// All variables of an image by their handles: those it was made with, and what was added later.
///
/// Segments are only ever added, by one thread at a time, and stay where they are; `count_` says
/// how many others may look at. So nobody waits for anybody.
class ImageSegments {
public:
    ImageSegments(const ImageLayout& layout, ImageMemory& memory, std::uint32_t max_segments)
        : layout_{&layout}, memory_{&memory}, segments_(max_segments)
    {
    }

    // Any thread.

    [[nodiscard]] std::uint32_t size() const;
    /// Null if there is none of this handle.
    [[nodiscard]] const ImagePlace* find(std::uint64_t handle) const;
    /// The number of the segment that has the handle; `handle` must be none of the first ones.
    [[nodiscard]] std::uint32_t segment_of(std::uint32_t handle) const;
    [[nodiscard]] std::uint32_t count() const { return count_.load(std::memory_order_acquire); }
    [[nodiscard]] ImageSegment& operator[](std::uint32_t index) const { return *segments_[index]; }

    // Who adds.

    [[nodiscard]] bool is_full() const { return count() == segments_.size(); }
    /// Of all variables.
    [[nodiscard]] std::size_t bytes() const;
    /// Behind all that there is: its first handle must be size().
    void add(std::unique_ptr<ImageSegment> segment);

    // The task.

    /// Where a variable lies in the task's memory.
    [[nodiscard]] std::byte* bytes_of(std::uint32_t handle) const;

private:
    const ImageLayout* layout_;
    ImageMemory* memory_;
    std::vector<std::unique_ptr<ImageSegment>> segments_;
    std::atomic<std::uint32_t> count_{0};
};

} // namespace busbar::server::detail
