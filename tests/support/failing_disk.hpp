#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// A disk that fails when a test wants it to. The linker puts it between the code under test and
/// the system (busbar_failing_disk in CMake): it sees every call that changes the disk. A byte that
/// is written is a step, and so is every other such call; fsync is counted and not waited for.
namespace busbar::test::failing_disk {

using Operation = std::function<void()>;

struct Steps {
    std::size_t count{0};
    /// Those by which a call begins and, of a call that writes, the next and the last byte too.
    std::vector<std::size_t> calls;
};

/// The steps that an operation takes when nothing fails.
[[nodiscard]] Steps steps_of(const Operation& operation);

/// Runs the operation; after so many steps the power is off: nothing reaches the disk any more, and
/// the code is told so. What was not synchronised until then is lost by half: the disk has the
/// names, but the second half of the bytes is gone.
void run_until_dark(std::size_t steps, const Operation& operation);

/// The same in a process of its own, which is killed after so many steps. True if it was.
[[nodiscard]] bool run_until_killed(std::size_t steps, const Operation& operation);

/// Runs the operation; the call after so many steps fails as if the disk were full, later ones work
/// again.
void run_with_failure(std::size_t step, const Operation& operation);

/// Renaming fails from here on as it does between two disks.
void set_two_disks(bool are_two);

/// Files that were opened to be read since the start.
[[nodiscard]] std::size_t count_of_reads();

/// What the disk does to a process that obeys, in memory that it shares with the one that orders.
/// Calls that change the disk have numbers, from 0 on. Any thread.
struct Orders {
    static constexpr std::uint64_t never = ~std::uint64_t{0};

    std::atomic<std::uint64_t> calls{0};
    /// The process is killed instead of this call, of which a write is done by half.
    std::atomic<std::uint64_t> killed_at{never};
    /// Calls from one number on fail up to the other, with this errno.
    std::atomic<std::uint64_t> fails_from{never};
    std::atomic<std::uint64_t> fails_until{never};
    std::atomic<int> error{0};
};
/// From now on the calls of this process are those of `orders`, which must outlive it, and nothing
/// else above counts.
void obey(Orders& orders);

} // namespace busbar::test::failing_disk
