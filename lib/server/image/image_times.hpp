#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/server/image_layout.hpp>

#include "core/fetch.hpp"
#include "image_copy.hpp"

namespace busbar::server::detail {

/// Copies the task's memory into a scan, and keeps the time when each variable of the layout last
/// changed, which is the source timestamp of its value (Part 4, 7.11.3).
///
/// The memory is compared with the previous scan in parts, and single variables are compared only
/// where a part differs. A part that has not changed since the scan's buffer was filled last is
/// there already: leaving it out saves more than the comparison costs.
///
/// The task writes and readers read without waiting for each other. A reader may hold an older scan
/// than the last one, so a variable's last change but one is kept, too.
class ImageTimes {
public:
    explicit ImageTimes(const ImageLayout& layout);

    /// A scan to be filled.
    struct Scan {
        ImageCopy& to;
        /// The number of the scan that `to` has; 0 for none.
        std::uint64_t filled;
        /// The previous scan; null if this is the first one.
        const ImageCopy* before;
        std::uint64_t number;
        DateTime time;
    };
    /// Called by the task. Never allocates; its steps are limited by the size of the image.
    void fill(const ImageMemory& memory, const Scan& scan);

    // Called on any thread.

    /// Returns when a variable had last changed in the scan of this time. Only if it has changed
    /// twice since, that scan's time.
    [[nodiscard]] DateTime last_change(std::size_t index, DateTime scan) const
    {
        const Stamp& stamp = stamps_[index];
        // acquire: `before` is at least as new as the value that `last` has replaced.
        const DateTime last{stamp.last.load(std::memory_order_acquire)};
        if (last <= scan) {
            return last;
        }
        const DateTime before{stamp.before.load(std::memory_order_relaxed)};
        return before <= scan ? before : scan;
    }
    void fetch(std::size_t index) const { busbar::detail::fetch(&stamps_[index]); }

private:
    struct Stamp {
        std::atomic<std::int64_t> last{0};
        std::atomic<std::int64_t> before{0};
    };
    struct Span {
        std::uint32_t offset;
        std::uint32_t size;
        std::uint32_t index;
    };
    /// The variables of one block, in the order of their offsets.
    struct Block {
        void add(const ImagePlace& place, std::uint32_t index);
        void finish(std::size_t size);

        std::vector<Span> spans;
        /// For each word of the block, the first variable that ends in it or later.
        std::vector<std::uint32_t> first;
        /// For each part of the block, the scan in which it last changed.
        std::vector<std::uint64_t> changed;
    };
    struct Array {
        std::uint32_t index;
        std::uint64_t changed{0};
    };

    void fill_all(const ImageMemory& memory, const Scan& scan);
    void fill_plain(const ImageMemory& memory, const Scan& scan);
    void fill_gathered(const ImageMemory& memory, const Scan& scan);
    void fill_arrays(const ImageMemory& memory, const Scan& scan);
    /// Stamps the variables in a part that differs.
    void note_part(const Block& block, const std::byte* before, const std::byte* now,
                   std::size_t begin, std::size_t size, DateTime time);
    void stamp(std::uint32_t index, DateTime time);

    Block plain_;
    Block gathered_;
    /// The variables that are arrays of numbers.
    std::vector<Array> arrays_;
    std::size_t count_;
    std::unique_ptr<Stamp[]> stamps_;
};

} // namespace busbar::server::detail
