#pragma once

#include <cstddef>
#include <new>
#include <optional>

#include <busbar/harness/engine_watch.hpp>

/// Memory that runs out where a test says. One file of the test's program includes
/// failing_memory_main.hpp, which replaces operator new; without it the program does not link. One
/// thread.
namespace busbar::harness {

/// Counts from now on: of what is allocated while a Counted lives, the `k`-th allocation fails and,
/// with a larger `most`, as many as that, one after the other. None fails with a `k` of 0.
void fail_allocation(std::size_t k, std::size_t most = 1);
/// Lets each counted allocation of at least so many bytes fail, until this is called with 0.
void fail_large_allocations(std::size_t size);
/// Returns whether the k-th counted allocation has been reached.
[[nodiscard]] bool has_allocation_failed();
/// Returns the number of allocations, counted or not, that have not been freed.
[[nodiscard]] std::size_t live_allocations();

/// Allocations are counted while it lives: the code under test runs, and not the test's own.
class Counted {
public:
    Counted();
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    ~Counted();
};

/// Allocations are not counted while it lives: within a Counted, a callback of the test's own runs,
/// such as a data source.
class Uncounted {
public:
    Uncounted();
    Uncounted(const Uncounted&) = delete;
    Uncounted& operator=(const Uncounted&) = delete;
    ~Uncounted();

private:
    bool was_counted_;
};

/// Does the work of the code under test; returns false if it threw std::bad_alloc.
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

/// Lets allocations of the server of a bench fail, and of its data sources, but for those within an
/// Uncounted; not those of its client or of the test:
///
///     FailingMemory memory;
///     BenchOptions options;
///     options.server_parts.watch = &memory;
///     Bench bench{options};
///     ...
///     memory.fail(k);
///     const DataValue value = bench.read(level); // Good, Bad_OutOfMemory, or a lost connection
///     is_finished = !memory.has_failed();        // there are fewer than k
///
/// Must outlive the bench. One at a time.
class FailingMemory final : public EngineWatch {
public:
    FailingMemory() = default;
    ~FailingMemory() override { fail_allocation(0); }

    /// Lets the server's `k`-th allocation from now on fail, and as many as `most`; 0: none.
    void fail(std::size_t k, std::size_t most = 1) { fail_allocation(k, most); }
    /// Returns whether it has come to that since fail().
    [[nodiscard]] bool has_failed() const { return has_allocation_failed(); }

    void enter() override { counted_.emplace(); }
    void leave() override { counted_.reset(); }

private:
    std::optional<Counted> counted_;
};

} // namespace busbar::harness
