#include <catch2/catch.hpp>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "programs/model_simulation.hpp"
#include "simulation/environment.hpp"
#include "support/effort.hpp"

namespace model_simulation_test {

using namespace busbar::test;

namespace {

constexpr std::size_t all_sequences = 500;
constexpr std::size_t sequences_of_round = 2;
constexpr std::size_t steps_of_sequence = 20;

} // namespace

// The environment says the same as for the other simulation, see controller_simulation_test.cpp.
TEST_CASE("a controller of model mode serves a project that was acknowledged, and always starts")
{
    const std::size_t part = part_of_round("model_simulation", all_sequences / sequences_of_round);
    const std::uint64_t first =
        number_from("BUSBAR_SIMULATION_SEED", is_full_effort() ? 1 : 1 + part * sequences_of_round);
    const std::uint64_t count = number_from("BUSBAR_SIMULATION_SEQUENCES",
                                            is_full_effort() ? all_sequences : sequences_of_round);
    ModelSimulation::Counts counts;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
        ModelSimulation simulation{seed};
        simulation.run(steps_of_sequence);
        if (!simulation.violations().empty()) {
            std::fprintf(stderr, "seed %llu\n%s\n", static_cast<unsigned long long>(seed),
                         simulation.story().c_str());
        }
        CAPTURE(seed);
        REQUIRE(simulation.violations() == std::vector<std::string>{});
        counts.written += simulation.counts().written;
        counts.updated += simulation.counts().updated;
        counts.refused += simulation.counts().refused;
        counts.unknown += simulation.counts().unknown;
        counts.starts += simulation.counts().starts;
    }
    // What is to be seen was there to be seen.
    CAPTURE(first, count);
    CHECK(counts.starts > 4 * count);
    CHECK(counts.written > 0);
    if (count >= 10 * sequences_of_round) {
        CHECK(counts.updated > count);
        CHECK(counts.refused > count);
        CHECK(counts.unknown > 0);
    }
}

} // namespace model_simulation_test
