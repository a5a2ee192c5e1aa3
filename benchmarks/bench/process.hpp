#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace busbar::bench {

/// Seconds of processor time that the threads which a process has now have had; 0 if there is none
/// of that id.
[[nodiscard]] double processor_time(pid_t process);

/// Milliseconds of processor time that the calling thread has had.
[[nodiscard]] double thread_time_ms();

/// Page faults that a process has had, whether or not something was read from a disk for them.
[[nodiscard]] double page_faults(pid_t process);

/// Resident memory in megabytes; zeros if there is no process of that id.
struct Memory {
    double now_mb{0};
    /// Most that it ever was, or was since forget_peak().
    double peak_mb{0};
};
[[nodiscard]] Memory memory_of(pid_t process);
/// Megabytes that are the process's own, exactly: without the pages of its program and libraries,
/// of which more are resident after each function that is used for the first time. 0 if there is no
/// process of that id.
[[nodiscard]] double own_memory_mb(pid_t process);
/// Has the system count the peak anew, which it lets only those do who may look into the process.
void forget_peak(pid_t process);

/// The threads of a process.
[[nodiscard]] std::vector<pid_t> threads_of(pid_t process);

/// The process that listens at the port of a URL whose host is this machine, as far as we may see
/// it.
[[nodiscard]] std::optional<pid_t> find_listener(const std::string& url);

} // namespace busbar::bench
