#include <catch2/catch.hpp>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "programs/controller_simulation.hpp"
#include "simulation/environment.hpp"
#include "support/effort.hpp"

namespace controller_simulation_test {

using namespace busbar::test;

namespace {

constexpr std::size_t all_sequences = 500;
/// Of which each round does so many, until all have had their turn.
constexpr std::size_t sequences_of_round = 4;
constexpr std::size_t steps_of_sequence = 20;

void add(ControllerSimulation::Counts& all, const ControllerSimulation::Counts& some)
{
    all.done += some.done;
    all.refused += some.refused;
    all.unknown += some.unknown;
    all.starts += some.starts;
    all.kills += some.kills;
    all.faults += some.faults;
}

} // namespace

// BUSBAR_SIMULATION_SEED and BUSBAR_SIMULATION_SEQUENCES say otherwise which seeds there are;
// BUSBAR_SIMULATION_TRACE prints the steps as they are done.
TEST_CASE("a controller that is killed after every step has what was acknowledged, nothing else, "
          "and always starts")
{
    const std::size_t part =
        part_of_round("controller_simulation", all_sequences / sequences_of_round);
    const std::uint64_t first =
        number_from("BUSBAR_SIMULATION_SEED", is_full_effort() ? 1 : 1 + part * sequences_of_round);
    const std::uint64_t count = number_from("BUSBAR_SIMULATION_SEQUENCES",
                                            is_full_effort() ? all_sequences : sequences_of_round);
    ControllerSimulation::Counts counts;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
        ControllerSimulation simulation{seed};
        simulation.run(steps_of_sequence);
        if (!simulation.violations().empty()) {
            std::fprintf(stderr, "seed %llu\n%s\n", static_cast<unsigned long long>(seed),
                         simulation.story().c_str());
        }
        CAPTURE(seed);
        REQUIRE(simulation.violations() == std::vector<std::string>{});
        add(counts, simulation.counts());
    }
    // What is to be seen was there to be seen.
    CAPTURE(first, count);
    if (count >= sequences_of_round) {
        CHECK(counts.starts > 8 * count);
        CHECK(counts.done > 2 * count);
        CHECK(counts.refused > 0);
        CHECK(counts.faults > 0);
    }
    if (count >= 10 * sequences_of_round) {
        CHECK(counts.unknown > 0);
        CHECK(counts.kills > count);
    }
}

} // namespace controller_simulation_test
