#include <catch2/catch.hpp>

#include "environment.hpp"
#include "machine_simulation.hpp"

namespace machine_simulation_test {

using namespace busbar::test;

namespace {

std::uint64_t replay(std::uint64_t seed)
{
    MachineSimulation simulation{seed};
    simulation.run(std::chrono::minutes{is_full_effort() ? 60 : 20});
    simulation.finish();
    return simulation.trace().hash();
}

} // namespace

TEST_CASE("a seed replays a controller whose media fail")
{
    const std::uint64_t seed = simulation_seed();
    CAPTURE(seed);
    const std::uint64_t hash = replay(seed);
    CHECK(replay(seed) == hash);
    CHECK(replay(seed + 1) != hash);
}

TEST_CASE("a controller keeps what it has saved while its media fail and its power goes "
          "(W588, 7-4 and 9-2-2)")
{
    const std::uint64_t seed = simulation_seed();
    const std::uint64_t hours = simulation_hours(BUSBAR_SIMULATION_HOURS);
    CAPTURE(seed, hours);
    MachineSimulation simulation{seed};
    simulation.run(std::chrono::hours{hours});
    simulation.finish();
    INFO(simulation.trace().violations());
    CHECK(simulation.trace().violation_count() == 0);

    // What is to be seen was there to be seen.
    const MachineSimulation::Counts& counts = simulation.counts();
    CHECK(counts.downloads.done > hours);
    CHECK(counts.restores.done > 0);
    CHECK(counts.power_cuts > hours);
    CHECK(counts.scans.done > 30 * hours);
    CHECK(counts.readings > 5 * hours);
    if (hours >= 24) {
        CHECK(counts.downloads.failed > 0);
        CHECK(counts.restores.failed > 0);
        CHECK(counts.failed_starts > 0);
        CHECK(counts.scans.failed > 0);
    }
}

} // namespace machine_simulation_test
