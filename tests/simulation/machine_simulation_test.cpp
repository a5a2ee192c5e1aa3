#include <catch2/catch.hpp>

#include <cstdlib>
#include <string>

#include "machine_simulation.hpp"

using namespace busbar::test;

namespace {

std::uint64_t number_from(const char* variable, std::uint64_t otherwise)
{
    const char* const text = std::getenv(variable);
    return text != nullptr ? std::stoull(text) : otherwise;
}

std::uint64_t replay(std::uint64_t seed)
{
    MachineSimulation simulation{seed};
    simulation.run(std::chrono::hours{1});
    simulation.finish();
    return simulation.trace().hash();
}

} // namespace

TEST_CASE("a seed replays a controller whose media fail")
{
    const std::uint64_t seed = number_from("BUSBAR_SIMULATION_SEED", 1);
    CAPTURE(seed);
    CHECK(replay(seed) == replay(seed));
    CHECK(replay(seed) != replay(seed + 1));
}

TEST_CASE("a controller keeps what it has saved while its media fail and its power goes "
          "(seed 000, 7-4 and 9-2-2)")
{
    const std::uint64_t seed = number_from("BUSBAR_SIMULATION_SEED", 1);
    const std::uint64_t hours = number_from("BUSBAR_SIMULATION_HOURS", BUSBAR_SIMULATION_HOURS);
    CAPTURE(seed, hours);
    MachineSimulation simulation{seed};
    simulation.run(std::chrono::hours{hours});
    simulation.finish();
    INFO(simulation.trace().violations());
    CHECK(simulation.trace().violation_count() == 0);

    // What is to be seen was there to be seen.
    const MachineSimulation::Counts& counts = simulation.counts();
    CHECK(counts.downloads > hours);
    CHECK(counts.restores > 0);
    CHECK(counts.power_cuts > hours);
    CHECK(counts.scans > 30 * hours);
    CHECK(counts.readings > 5 * hours);
    if (hours >= 24) {
        CHECK(counts.refused_downloads > 0);
        CHECK(counts.refused_restores > 0);
        CHECK(counts.failed_starts > 0);
        CHECK(counts.failed_scans > 0);
    }
}
