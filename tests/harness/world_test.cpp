#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <thread>

#include <busbar/harness/link.hpp>
#include <busbar/harness/world.hpp>

namespace world_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

struct QuietEnd final : LinkEnd {
    [[nodiscard]] std::span<const std::byte> output() const override { return {}; }
    void consume(std::size_t) override {}
    void feed(std::span<const std::byte>) override {}
    void link_lost() override { is_lost = true; }

    bool is_lost{false};
};

} // namespace

TEST_CASE("things happen in the order of their time and, at one time, of asking", "[harness]")
{
    World world;
    std::string order;
    world.scheduler().after(2s, [&] { order += "c"; });
    world.scheduler().after(1s, [&] {
        order += "a";
        world.scheduler().at(TimePoint{}, [&] { order += "b"; }); // is over: now
    });
    world.run_for(1s);
    CHECK(order == "ab");
    CHECK(world.now() == TimePoint{1s});
    CHECK(world.scheduler().next_due() == TimePoint{2s});
    CHECK(world.step());
    CHECK(order == "abc");
    CHECK(world.now() == TimePoint{2s});
    CHECK_FALSE(world.step());
    CHECK(world.scheduler().next_due() == no_deadline);
}

TEST_CASE("a run ends with its condition or its limit", "[harness]")
{
    World world;
    bool is_there = false;
    world.scheduler().after(5s, [&] { is_there = true; });
    CHECK_FALSE(world.run_until([&] { return is_there; }, 4s));
    CHECK(world.now() == TimePoint{4s});
    CHECK(world.run_until([&] { return is_there; }, 4s));
    CHECK(world.now() == TimePoint{5s});
    CHECK(world.run_until([&] { return is_there; }, 4s));
    CHECK(world.now() == TimePoint{5s});
}

TEST_CASE("an alarm can be set anew, cancelled and forgotten", "[harness]")
{
    World world;
    int count = 0;
    {
        Alarm alarm{world.scheduler(), [&] { ++count; }};
        alarm.set_after(3s);
        alarm.set_after(1s);
        world.run_for(2s);
        CHECK(count == 1);
        CHECK_FALSE(alarm.is_set());
        world.run_for(2s);
        CHECK(count == 1);
        alarm.set_after(1s);
        alarm.cancel();
        world.run_for(2s);
        CHECK(count == 1);
        alarm.set_after(1s);
    }
    world.run_for(2s);
    CHECK(count == 1);
}

TEST_CASE("the end of a connection is held with what is sent before it", "[harness]")
{
    World world;
    QuietEnd client;
    QuietEnd server;
    const auto link =
        std::make_shared<Link>(world.scheduler(), world.network().weather(), Chance{1, 1});
    link->attach(Side::Client, client);
    link->attach(Side::Server, server);
    link->hold(Side::Server);
    link->close(Side::Server);
    world.run_for(1s);
    CHECK_FALSE(client.is_lost);
    link->release(Side::Server);
    world.run_for(1s);
    CHECK(client.is_lost);
}

TEST_CASE("the time of day jumps and monotonic time does not notice", "[harness]")
{
    World world{1, DateTime::from_unix_seconds(1'000)};
    world.run_for(5s);
    CHECK(world.clock().now() == DateTime::from_unix_seconds(1'005));
    world.jump_clock(-1h);
    CHECK(world.clock().now() == DateTime::from_unix_seconds(1'005 - 3'600));
    CHECK(world.now() == TimePoint{5s});
}

TEST_CASE("an actor's randomness depends on the seed and its own number", "[harness]")
{
    World a{7};
    World b{7};
    static_cast<void>(b.new_chance(Actor::Server));
    CHECK(a.new_chance(Actor::Client).next() == b.new_chance(Actor::Client).next());
    CHECK(a.new_chance(Actor::Client).next() != World{7}.new_chance(Actor::Client).next());
    CHECK(World{8}.new_chance(Actor::Client).next() != World{7}.new_chance(Actor::Client).next());
}

TEST_CASE("a world runs in real time under a driver that has the clock", "[harness]")
{
    World world;
    std::string heard;
    Signal signal{world.scheduler(), [&] { heard += "signal "; }};
    world.scheduler().after(30ms, [&] { heard += "alarm "; });
    // The driver's clock, and how long it waits.
    Duration elapsed{0};
    int rounds = 0;
    for (; elapsed < 50ms && rounds < 100; ++rounds) {
        world.run_until(TimePoint{elapsed});
        if (rounds == 1) {
            std::thread{[&] { signal.raise(); }}.join(); // as the thread of a data source does
            CHECK(world.scheduler().next_due() == world.now());
        }
        elapsed += std::clamp<Duration>(world.scheduler().next_due() - world.now(), 1ms, 10ms);
    }
    CHECK(heard == "signal alarm ");
    CHECK(rounds < 10);
}

} // namespace world_test
