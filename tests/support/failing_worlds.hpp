#pragma once

#include <cstddef>
#include <string_view>
#include <utility>

#include <catch2/catch.hpp>

#include "effort.hpp"
#include "failing_allocation.hpp"

namespace busbar::test {

inline std::size_t next_allocation(std::size_t k)
{
    return k + 1;
}

/// Calls `fail(k)` for k = 1, `next(1)`, ... until it is false; unless the effort is full, for the
/// round's fifth of the first 30 of these and its 41st of the others. Each time it makes a
/// world, has the k-th allocation fail there, and tells whether it came to that; nothing that was
/// allocated may be left when the world is gone. `what` is to be seen where something is.
template <typename Fail>
void check_failing_worlds(std::string_view what, Fail fail,
                          std::size_t (*next)(std::size_t) = next_allocation)
{
    REQUIRE_FALSE(fail(1'000'000)); // after which all is there that lasts as long as the program
    bool has_failed = true;
    const std::size_t round = part_of_round(what, 5 * 41);
    std::size_t index = 0;
    for (std::size_t k = 1; has_failed; k = next(k), ++index) {
        const std::size_t parts = index < 30 ? 5 : 41;
        if (!is_full_effort() && index % parts != round % parts) {
            continue;
        }
        const std::size_t before = live_allocations();
        has_failed = fail(k);
        const std::size_t after = live_allocations();
        INFO(what << ", allocation " << k);
        CHECK(after == before);
    }
}

/// Has `work`, which is false if it refused, done with the `k`-th allocation failing, and again if
/// that was the end of it. `check` sees what such an end has left. False if it went through.
template <typename Work, typename Check>
bool fail_and_repeat(std::size_t k, Work work, Check check)
{
    bool is_done = false;
    fail_allocation(k);
    const bool has_survived = survives_counted([&] { is_done = work(); });
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k);
    CHECK((has_failed || (has_survived && is_done)));
    if (!has_survived || !is_done) {
        check();
        CHECK(work());
    }
    return has_failed;
}

template <typename Work>
bool fail_and_repeat(std::size_t k, Work work)
{
    return fail_and_repeat(k, std::move(work), [] {});
}

} // namespace busbar::test
