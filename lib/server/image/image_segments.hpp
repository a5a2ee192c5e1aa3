#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/server/image_memory.hpp>

#include "image_copy.hpp"
#include "image_times.hpp"

namespace busbar::server::detail {

/// Variables that were added to an image together, with everything that the task and its readers
/// need.
struct ImageSegment {
    ImageSegment(ImageLayout added, std::uint32_t first_handle)
        : layout{std::move(added)}, memory{layout}, times{layout}, first{first_handle}
    {
    }

    ImageLayout layout;
    /// Used by the task.
    ImageMemory memory;
    ImageTimes times;
    /// The handle of the first variable.
    std::uint32_t first;
    /// The copy of these variables for each buffer of the pool.
    std::vector<ImageCopy> copies;
};

/// All variables of an image by their handles: the initial ones and those that were added later.
///
/// Segments are only ever added, by one thread at a time, and keep their addresses; `count_` is the
/// number that other threads may read. So no thread waits for another.
class ImageSegments {
public:
    ImageSegments(const ImageLayout& layout, ImageMemory& memory, std::uint32_t max_segments)
        : layout_{&layout}, memory_{&memory}, segments_(max_segments)
    {
    }

    // Called on any thread.

    [[nodiscard]] std::uint32_t size() const;
    /// Returns null if there is none with this handle.
    [[nodiscard]] const ImagePlace* find(std::uint64_t handle) const;
    /// Returns the index of the segment with the handle, which must not be an initial one.
    [[nodiscard]] std::uint32_t segment_of(std::uint32_t handle) const;
    [[nodiscard]] std::uint32_t count() const { return count_.load(std::memory_order_acquire); }
    [[nodiscard]] ImageSegment& operator[](std::uint32_t index) const { return *segments_[index]; }

    // Called by the thread that adds.

    [[nodiscard]] bool is_full() const { return count() == segments_.size(); }
    /// Bytes of all variables.
    [[nodiscard]] std::size_t bytes() const;
    /// Adds a segment at the end: its first handle must be size().
    void add(std::unique_ptr<ImageSegment> segment);

    // Called by the task.

    /// Returns the address of a variable in the task's memory.
    [[nodiscard]] std::byte* bytes_of(std::uint32_t handle) const;

private:
    const ImageLayout* layout_;
    ImageMemory* memory_;
    std::vector<std::unique_ptr<ImageSegment>> segments_;
    std::atomic<std::uint32_t> count_{0};
};

} // namespace busbar::server::detail
