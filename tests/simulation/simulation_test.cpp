#include <catch2/catch.hpp>

#include "environment.hpp"
#include "simulation.hpp"

namespace simulation_test {

using namespace busbar::test;

namespace {

/// The hash of what happened.
std::uint64_t replay(std::uint64_t seed)
{
    Simulation simulation{{seed, 6}};
    simulation.run(std::chrono::minutes{is_full_effort() ? 60 : 15});
    return simulation.trace().hash();
}

} // namespace

TEST_CASE("a simulation's seed replays it")
{
    const std::uint64_t seed = simulation_seed();
    CAPTURE(seed);
    const std::uint64_t hash = replay(seed);
    CHECK(replay(seed) == hash);
    CHECK(replay(seed + 1) != hash);
}

TEST_CASE("no notification is lost in a day of 50 clients over links that break, and nothing grows")
{
    const std::uint64_t seed = simulation_seed();
    const std::chrono::minutes all = simulation_time(std::chrono::minutes{30});
    CAPTURE(seed, all.count());
    Simulation simulation{{seed, 50}};
    // Warms up: buffers and tables that stay have their size afterwards, when every attacker has
    // tried each of his ways.
    const std::chrono::minutes first =
        std::min<std::chrono::minutes>(std::chrono::hours{1}, all / 2);
    simulation.run(first);
    simulation.finish();
    const std::size_t heap_before = Simulation::heap_in_use();
    simulation.run(all - first);
    simulation.finish();
    const std::size_t heap_after = Simulation::heap_in_use();

    INFO(simulation.trace().violations());
    CHECK(simulation.trace().violation_count() == 0);
    CHECK(simulation.trace().notes() > 1'000 * static_cast<std::uint64_t>(all.count()) / 60);
    // Tables keep the size of their fullest moment.
    CHECK(heap_after <= heap_before + 256 * 1'024);
}

} // namespace simulation_test
