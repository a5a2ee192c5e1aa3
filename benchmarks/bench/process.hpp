#pragma once

#include <sys/types.h>

namespace busbar::bench {

/// Seconds of processor time that a process has had; 0 if there is none of that id.
[[nodiscard]] double processor_time(pid_t process);

/// Resident memory in megabytes; zeros if there is no process of that id.
struct Memory {
    double now_mb{0};
    /// Most that it ever was, or was since forget_peak().
    double peak_mb{0};
};
[[nodiscard]] Memory memory_of(pid_t process);
/// Has the system count the peak anew, which it lets only those do who may look into the process.
void forget_peak(pid_t process);

} // namespace busbar::bench
