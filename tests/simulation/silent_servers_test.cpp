#include <catch2/catch.hpp>

#include "environment.hpp"
#include "moody_server.hpp"
#include "registration_watch.hpp"
#include "silence_watch.hpp"

namespace silent_servers_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// How long the server is well before all values must be there again: as long as the longest pause
/// of the client and the time in which it notices a silence.
constexpr Duration recovery = 8min;

struct Outcome {
    std::uint64_t hash{0};
    std::size_t violation_count{0};
    std::string violations;
    std::uint64_t values{0};
    std::uint64_t ended{0};
    std::uint64_t connections{0};
    std::uint64_t ignored_renewals{0};
};

void pass(World& world, SilenceWatch& watch, RegistrationWatch& registration, Duration time)
{
    for (const TimePoint end = world.now() + time; world.now() < end;) {
        world.run_for(10s);
        watch.check();
        registration.check();
    }
}

Outcome simulate(std::uint64_t seed, Duration time)
{
    World world{seed};
    world.network().weather().max_latency = 20ms;
    Trace trace{world.scheduler()};
    Outcome outcome;
    Chance chance{seed, 0};
    {
        MoodyServer server{world, "opc.tcp://moody:4840"};
        SilenceWatch watch{world, server, trace};
        RegistrationWatch registration{world, trace};
        for (const TimePoint end = world.now() + time; world.now() < end;) {
            for (std::size_t i = 1 + chance.below(4); i > 0; --i) {
                server.change_moods();
                if (chance.one_in(4)) {
                    server.forget_sessions();
                }
                if (chance.one_in(4)) {
                    server.forget_subscriptions();
                }
                for (std::size_t j = 1 + chance.below(10); j > 0; --j) {
                    watch.act();
                    pass(world, watch, registration, chance.between(10s, 2min));
                }
            }
            server.be_well();
            pass(world, watch, registration, 30s); // what is under way still fails
            watch.begin_recovery();
            registration.begin_recovery();
            pass(world, watch, registration, recovery);
            watch.check_recovery();
            registration.check_recovery();
        }
        watch.leave();
        outcome.values = watch.values();
        outcome.ended = watch.ended();
        outcome.connections = watch.connections();
        outcome.ignored_renewals = server.ignored_renewals();
    }
    outcome.hash = trace.hash();
    outcome.violation_count = trace.violation_count();
    outcome.violations = trace.violations();
    return outcome;
}

} // namespace

TEST_CASE("a client never waits for ever, whatever a server answers, forgets or keeps to itself")
{
    const std::uint64_t first = simulation_seed();
    const std::uint64_t seeds = number_from("BUSBAR_SIMULATION_SEEDS", is_full_effort() ? 20 : 3);
    const std::chrono::minutes time = simulation_time(std::chrono::hours{4});
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
        const Outcome outcome = simulate(seed, time);
        CAPTURE(seed, time.count());
        INFO(outcome.violations);
        CHECK(outcome.violation_count == 0);
        // It was not idle.
        const auto minutes = static_cast<std::uint64_t>(time.count());
        CHECK(outcome.values > minutes);
        CHECK(outcome.ended > minutes / 10);
        CHECK(outcome.connections > minutes / 60);
        CHECK(outcome.ignored_renewals > minutes / 240);
    }
}

TEST_CASE("a simulation of silent servers is replayed by its seed")
{
    const std::uint64_t seed = simulation_seed();
    const Outcome one = simulate(seed, 30min);
    CHECK(simulate(seed, 30min).hash == one.hash);
    CHECK(simulate(seed + 1, 30min).hash != one.hash);
}

} // namespace silent_servers_test
