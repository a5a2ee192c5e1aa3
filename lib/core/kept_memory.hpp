#pragma once

#include <chrono>
#include <cstddef>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>

namespace busbar::detail {

/// Large blocks that requests use in turn (see large_memory.hpp): up to a set number of bytes,
/// without blocks that have not been used for a while.
///
/// A block returns to the KeptMemory that it was taken from, whichever thread frees it, and may
/// outlive it. Nothing here ever waits: while another thread is at it, memory is allocated and
/// freed as usual. All other calls are the owner's.
class BUSBAR_API KeptMemory {
public:
    /// Minimum time that a block is kept; the maximum is twice that.
    static constexpr Duration age = std::chrono::seconds{10};

    explicit KeptMemory(std::size_t max_bytes);
    KeptMemory(const KeptMemory&) = delete;
    KeptMemory& operator=(const KeptMemory&) = delete;
    ~KeptMemory();

    [[nodiscard]] std::size_t held() const;
    /// Call it after each use: from then on the age of its blocks counts.
    void note(TimePoint now)
    {
        if (deadline_ == no_deadline && held() != 0) {
            deadline_ = now + age;
        }
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadline_; }
    /// Frees blocks that were not used since the last call.
    void handle_deadline(TimePoint now);

    /// The blocks, which live as long as there is one that may return.
    class Pool;

private:
    friend void* allocate_large(std::size_t bytes, KeptMemory* memory);

    Pool* pool_;
    TimePoint deadline_{no_deadline};
};

} // namespace busbar::detail
