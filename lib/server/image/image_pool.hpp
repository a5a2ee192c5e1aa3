#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include <busbar/core/date_time.hpp>

#include "image_segments.hpp"

namespace busbar::server::detail {

/// One scan as readers see it.
class ImageBuffer { // NOLINT(*-optin.performance.Padding): a line of cache for each thread
public:
    ImageBuffer(const ImageLayout& layout, std::uint32_t index) : copy_{layout}, index_{index} {}

    /// Fills it with the present segments as well, and notes in `times` and theirs what has changed
    /// since the previous scan; null if this is the first one.
    void fill(const ImageMemory& memory, const ImageSegments& segments, ImageTimes& times,
              const ImageBuffer* before, DateTime time);

    [[nodiscard]] DateTime time() const { return time_; }
    [[nodiscard]] std::uint64_t scan() const { return scan_; }
    /// The copy of the initial variables.
    [[nodiscard]] const ImageCopy& copy() const { return copy_; }
    /// Number of segments in this scan; index of this buffer's copies.
    [[nodiscard]] std::uint32_t segments() const { return segments_; }
    [[nodiscard]] std::uint32_t index() const { return index_; }

private:
    friend class ImagePool;

    ImageCopy copy_;
    std::uint32_t index_;
    std::uint32_t segments_{0};
    DateTime time_;
    std::uint64_t scan_{0};
    /// Pins that were taken while this was the latest buffer, known to the task when it no longer
    /// is; used by the task only.
    std::uint64_t taken_{0};
    /// Pins that were returned. The buffer is free when both are equal. In another cache line than
    /// what readers only read, and than the next buffer.
    alignas(64) std::atomic<std::uint64_t> released_{0};
};

/// The buffers of an image, and the latest of them. Both sides are wait-free: neither has a loop
/// that the other could prolong.
///
/// `latest_` has the index of the latest buffer in its upper bits and the number of its pins in its
/// lower ones, so that one fetch_add both takes a pin and identifies its buffer, and one exchange
/// both publishes and reads the final count of the previous buffer. There is no moment in which a
/// reader knows a buffer and has not pinned it.
///
/// A scan that is queued for the follower is published with one pin already taken, which stays with
/// it in the queue: the task takes it, the follower returns it.
///
/// At most `max_pins` pins are held at a time, `max_queued` wait in the queue and one is with the
/// follower; there are two buffers more. When the task looks for a free one it has just published,
/// so that only the latest can be pinned: of the others, one more than there are pins, at least one
/// has no pin, and none can get one while the task looks.
class ImagePool { // NOLINT(*-optin.performance.Padding): a line of cache for each thread
public:
    ImagePool(const ImageLayout& layout, std::uint32_t max_pins, std::uint32_t max_queued);

    // Called on the task's thread.

    /// Returns true if the scan was queued for the follower.
    bool publish(const ImageMemory& memory, const ImageSegments& segments, DateTime time);

    // Called on any thread.

    [[nodiscard]] std::size_t size() const { return buffers_.size(); }
    /// When the initial variables last changed.
    [[nodiscard]] const ImageTimes& times() const { return times_; }
    /// Returns null if nothing was published or too many pins are held.
    [[nodiscard]] ImageBuffer* pin();
    void unpin(ImageBuffer& buffer);
    [[nodiscard]] bool is_empty() const;

    // Called on the follower's thread, of which there is one.

    /// Starts or stops queueing each scan; clears the queue.
    void follow(bool follows);
    /// Returns the oldest scan in the queue, with a pin that unpin() returns; null if there is
    /// none. Only one at a time.
    [[nodiscard]] ImageBuffer* next_queued();

private:
    static constexpr unsigned index_shift = 48;
    static constexpr std::uint64_t no_buffer = UINT16_MAX;

    [[nodiscard]] std::uint64_t find_free() const;
    [[nodiscard]] ImageBuffer& at(std::uint64_t index) const
    {
        return *buffers_[static_cast<std::size_t>(index)];
    }
    [[nodiscard]] std::uint64_t& queued(std::uint64_t position)
    {
        return queue_[static_cast<std::size_t>(position % queue_.size())];
    }

    std::vector<std::unique_ptr<ImageBuffer>> buffers_;
    ImageTimes times_;
    std::uint32_t max_pins_;
    /// A ring of buffer indices, from the task to the follower; the counters never wrap.
    std::vector<std::uint64_t> queue_;
    std::atomic<std::uint64_t> queue_begin_{0};
    std::atomic<std::uint64_t> queue_end_{0};
    std::atomic<bool> is_followed_{false};
    std::uint64_t current_{no_buffer};
    alignas(64) std::atomic<std::uint64_t> latest_{no_buffer << index_shift};
    alignas(64) std::atomic<std::uint32_t> held_{0};
};

} // namespace busbar::server::detail
