#pragma once

#include <chrono>
#include <cstddef>

#include <busbar/core/clock.hpp>

namespace busbar::net::detail {

/// Bytes of this process.
struct ProcessMemory {
    /// In the machine's memory.
    std::size_t resident{0};
    /// What malloc keeps for later, resident or not.
    std::size_t free{0};
};
/// Zeros where the C library or the system does not tell.
[[nodiscard]] ProcessMemory process_memory();
/// Has malloc give the system all pages on which nothing is; nothing where it cannot. Takes some
/// milliseconds if that is much.
void return_free_memory();

/// When the memory that a flood took is given back. malloc keeps what lies below something that is
/// still used, and what is freed in pieces. A state machine; polled by its owner.
class MemoryReturn {
public:
    /// From something that happened to when the memory is looked at.
    static constexpr Duration delay = std::chrono::seconds{10};
    /// Less is not worth the time.
    static constexpr std::size_t least = 4U << 20U;

    /// Something happened that may have taken memory.
    void note_activity(TimePoint now)
    {
        if (deadline_ == no_deadline) {
            deadline_ = now + delay;
        }
    }
    [[nodiscard]] TimePoint next_deadline() const { return deadline_; }
    /// True if free memory should be returned: there is some, and more of it, or more resident,
    /// than was left the last time, as malloc counts what it returned as free. Call returned()
    /// behind it.
    [[nodiscard]] bool handle_deadline(TimePoint now, const ProcessMemory& memory);
    void returned(const ProcessMemory& memory) { left_ = memory; }

private:
    TimePoint deadline_{no_deadline};
    ProcessMemory left_;
};

} // namespace busbar::net::detail
