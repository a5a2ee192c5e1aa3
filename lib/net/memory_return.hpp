#pragma once

#include <chrono>
#include <cstddef>

#include <busbar/core/clock.hpp>

namespace busbar::net::detail {

/// Memory of this process, in bytes.
struct ProcessMemory {
    /// Bytes in the machine's memory.
    std::size_t resident{0};
    /// Bytes that malloc keeps for later, resident or not.
    std::size_t free{0};
};
/// Returns zeros if the C library or the system does not provide them.
[[nodiscard]] ProcessMemory process_memory() noexcept;
/// Makes malloc keep what is freed, up to 32 MB, instead of returning and taking the same pages
/// with each large request: the 10,000 lists of a Browse took 2,000 page faults, and a client's
/// Read of 1,000 values spent nearly half of its time on them. The caller must also call
/// return_free_memory() when the process is idle. Settings of the environment win.
void keep_free_memory();
/// Makes malloc return all unused pages to the system; does nothing if it cannot. Takes some
/// milliseconds for many pages.
void return_free_memory() noexcept;

/// Decides when the memory that a flood took is returned. malloc keeps memory below something that
/// is still used, and what is freed in pieces. A state machine, polled by its owner.
class MemoryReturn {
public:
    /// Time from an activity until the memory is checked.
    static constexpr Duration delay = std::chrono::seconds{10};
    /// Minimum amount that is worth the time.
    static constexpr std::size_t least = 4U << 20U;

    /// Call it after an activity that may have taken memory.
    void note_activity(TimePoint now)
    {
        if (deadline_ == no_deadline) {
            deadline_ = now + delay;
        }
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadline_; }
    /// Returns true if free memory should be returned: there is some, and more of it, or more
    /// resident, than remained the last time, as malloc counts returned memory as free. Call
    /// returned() after it.
    [[nodiscard]] bool handle_deadline(TimePoint now, const ProcessMemory& memory);
    void returned(const ProcessMemory& memory) { left_ = memory; }
    /// Checks the memory of the process, and returns what is free. Does nothing before the
    /// deadline.
    void look(TimePoint now) noexcept;

private:
    TimePoint deadline_{no_deadline};
    ProcessMemory left_;
};

} // namespace busbar::net::detail
