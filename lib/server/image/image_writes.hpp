#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "image_changes.hpp"

namespace busbar::server::detail {

/// Write calls on their way to a PLC task and back: a ring that only the server's thread adds to
/// and removes from. The task moves along it and changes no place, so that it never frees memory.
/// Both sides are wait-free.
///
///     collected_ <= finished_ <= begun_ <= head_ <= collected_ + capacity
///
/// Up to `finished_` the results belong to the server again, up to `begun_` the task has applied
/// the calls to its memory but not published it, up to `head_` they wait.
class ImageWrites { // NOLINT(*-optin.performance.Padding): a line of cache for each thread
public:
    ImageWrites(std::uint32_t capacity, std::size_t max_bytes)
        : slots_(capacity), max_bytes_{max_bytes}
    {
    }

    // Called on the server's thread.

    [[nodiscard]] bool is_full() const { return size() == slots_.size(); }
    /// A single call always has room.
    [[nodiscard]] bool has_room_for(const ImageChanges& changes) const
    {
        return !is_full() && (bytes_ == 0 || bytes_ + changes.memory() <= max_bytes_);
    }
    /// Only call it if there is room.
    void push(std::unique_ptr<ImageChanges> changes);
    /// Returns the next call that has its results, or null.
    [[nodiscard]] std::unique_ptr<ImageChanges> collect();
    /// Called when the source ends: discards the results of waiting calls.
    void drop_batches();

    // Called on the task's thread.

    /// Returns the next call that waits, or null; it stays next until begin().
    [[nodiscard]] ImageChanges* next();
    void begin() { ++begun_; }
    /// Completes every call that was begun; true if there was one.
    bool finish();

private:
    [[nodiscard]] std::uint64_t size() const
    {
        return head_.load(std::memory_order_relaxed) - collected_;
    }
    [[nodiscard]] std::unique_ptr<ImageChanges>& slot(std::uint64_t position)
    {
        return slots_[static_cast<std::size_t>(position % slots_.size())];
    }

    std::vector<std::unique_ptr<ImageChanges>> slots_;
    std::size_t max_bytes_;
    std::size_t bytes_{0};       // the server's: of calls that were pushed and not collected
    std::uint64_t collected_{0}; // the server's
    alignas(64) std::atomic<std::uint64_t> head_{0};
    alignas(64) std::atomic<std::uint64_t> finished_{0};
    std::uint64_t begun_{0}; // the task's
};

} // namespace busbar::server::detail
