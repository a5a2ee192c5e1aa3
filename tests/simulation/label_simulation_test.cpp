#include <array>

#include <catch2/catch.hpp>

#include "environment.hpp"
#include "label_simulation.hpp"

namespace label_simulation_test {

using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

std::uint64_t replay(std::uint64_t seed)
{
    LabelSimulation simulation{{seed, 5}};
    simulation.run(10s);
    simulation.finish();
    return simulation.trace().hash();
}

} // namespace

TEST_CASE("a seed replays a simulation of labels that change")
{
    const std::uint64_t seed = simulation_seed();
    CAPTURE(seed);
    const std::uint64_t hash = replay(seed);
    CHECK(replay(seed) == hash);
    CHECK(replay(seed + 1) != hash);
}

TEST_CASE("50 clients see no wrong value while labels change (SH-082679, 8.3 and 10.3)")
{
    const std::uint64_t seed = simulation_seed();
    // One of them a day, all at full effort.
    constexpr std::array modes{SamplingMode::Standard, SamplingMode::MonitoredItems,
                               SamplingMode::AllVariables};
    const auto mode = GENERATE_COPY(range(std::size_t{0}, modes.size()));
    if (!is_full_effort() && mode != part_of_round("sampling", modes.size())) {
        return;
    }
    const SamplingMode sampling = modes[mode];
    CAPTURE(seed, static_cast<int>(sampling));
    LabelSimulation simulation{{seed, 50, sampling}};
    simulation.run(20s);
    simulation.finish();
    INFO(simulation.trace().violations());
    CHECK(simulation.trace().violation_count() == 0);

    // What is to be seen was there to be seen.
    std::uint64_t good = 0;
    std::uint64_t bad = 0;
    std::uint64_t overloads = 0;
    for (const auto& client : simulation.clients()) {
        good += client->good();
        bad += client->bad();
        overloads += client->overloads();
    }
    CHECK(simulation.downloads() > 15);
    CHECK(good > 10'000);
    CHECK(bad > 100);
    CHECK(overloads > 10);
    const auto& events = simulation.book().events;
    CHECK(std::count(events.begin(), events.end(), LabelUpdate::Finished) > 5);
    CHECK(std::count(events.begin(), events.end(), LabelUpdate::Failed) > 0);
}

} // namespace label_simulation_test
