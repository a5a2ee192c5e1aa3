#pragma once

#include <cstddef>
#include <new>

/// Memory that runs out for a moment, where a test says. Needs failing_allocation.cpp in the test,
/// which replaces operator new; one thread.
namespace busbar::test {

/// Counts anew: of what is allocated while a Counted lives, the `k`-th fails and, with a larger
/// `most`, as many after it. None fails with 0.
void fail_allocation(std::size_t k, std::size_t most = 1);
/// The same for every one of at least so many bytes, for as long as that is not 0.
void fail_large_allocations(std::size_t size);
/// Whether it has come to that, of those that are counted.
[[nodiscard]] bool has_allocation_failed();
/// What was allocated, counted or not, and not freed.
[[nodiscard]] std::size_t live_allocations();

/// While it lives the code under test runs, and not the test's own.
class Counted {
public:
    Counted();
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    ~Counted();
};

/// Has `work` done by the code under test; false if it threw std::bad_alloc.
template <typename Work>
[[nodiscard]] bool survives_counted(Work work)
{
    try {
        const Counted while_it_works;
        work();
    } catch (const std::bad_alloc&) {
        return false;
    }
    return true;
}

/// While it lives in that, a callback of the test's own runs.
class Uncounted {
public:
    Uncounted();
    Uncounted(const Uncounted&) = delete;
    Uncounted& operator=(const Uncounted&) = delete;
    ~Uncounted();

private:
    bool was_counted_;
};

} // namespace busbar::test
