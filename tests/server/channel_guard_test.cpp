#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "server/engine/channel_guard.hpp"

namespace channel_guard_test {

using namespace busbar;
using namespace std::chrono_literals;
using server::detail::ChannelGuard;
using server::detail::ConnectionGate;

namespace {

constexpr Duration no_end = Duration::max();

/// A guard with limits that are easy to reckon with, and its time.
struct Guarded {
    Guarded()
    {
        limits.max_channel_burst = 3;
        limits.channel_interval = 100ms;
        limits.max_channel_failures = 2;
        limits.failed_channel_interval = 1s;
        limits.max_channel_delay = 2'500ms;
        limits.max_channel_entries = 4;
    }
    /// How long each of `count` requests of one moment waits; -1 for what is refused.
    std::vector<int> ask(std::string_view source, int count)
    {
        std::vector<int> waits;
        while (count-- > 0) {
            const auto admission = guard.admit(source, no_end, now);
            waits.push_back(admission.is_admitted ? static_cast<int>(admission.wait / 1ms) : -1);
        }
        return waits;
    }
    void fail(std::string_view source, int count)
    {
        while (count-- > 0) {
            guard.failed(source, now);
        }
    }

    server::ServerLimits limits;
    ChannelGuard guard{limits};
    TimePoint now{1h};
};

using Waits = std::vector<int>;

} // namespace

TEST_CASE_METHOD(Guarded, "some channels are opened at once, the others one after the other")
{
    CHECK(ask("a", 6) == Waits{0, 0, 0, 100, 200, 300});
    CHECK(ask("b", 1) == Waits{0}); // others are not concerned
    now += 600ms;
    CHECK(ask("a", 4) == Waits{0, 0, 0, 100});
}

TEST_CASE_METHOD(Guarded, "what would wait too long is refused, and takes nothing")
{
    CHECK(ask("a", 30).back() == -1);
    CHECK(ask("a", 1) == Waits{-1});
    now += 100ms;
    CHECK(ask("a", 2) == Waits{2'500, -1});
    SECTION("a connection may have less time")
    {
        now += 100ms;
        CHECK_FALSE(guard.admit("a", 1s, now).is_admitted);
        CHECK(guard.admit("a", 3s, now).is_admitted);
    }
}

TEST_CASE_METHOD(Guarded, "after failures each request waits the longer interval")
{
    fail("a", 1);
    CHECK(ask("a", 1) == Waits{0}); // one mistake is none
    fail("a", 1);
    now += 100ms;
    CHECK(ask("a", 5) == Waits{0, 1'000, 2'000, -1, -1});
    CHECK(ask("b", 3) == Waits{0, 0, 0});
    SECTION("each is forgiven in time")
    {
        now += 3s;
        CHECK(ask("a", 3) == Waits{0, 0, 0});
    }
    SECTION("however many there were")
    {
        fail("a", 1'000);
        now += 2'899ms; // 4 are counted, and 2 of them left
        CHECK(ask("a", 2) == Waits{101, 1'101});
        now += 2'202ms;
        CHECK(ask("a", 3) == Waits{0, 0, 0});
    }
}

TEST_CASE_METHOD(Guarded, "a channel that works gives back what it cost and forgives")
{
    CHECK(ask("a", 3) == Waits{0, 0, 0});
    guard.worked("a", 100ms);
    CHECK(ask("a", 2) == Waits{0, 100});
    fail("a", 5);
    guard.worked("a", 100ms);
    CHECK(ask("a", 2) == Waits{100, 200});
    guard.worked("b", 100ms); // forgotten meanwhile
    CHECK(ask("b", 4) == Waits{0, 0, 0, 100});
}

TEST_CASE_METHOD(Guarded, "the log is told once of a source, until one has not to wait")
{
    fail("a", 4);
    CHECK(ask("a", 3) == Waits{0, 1'000, 2'000});
    CHECK_FALSE(guard.admit("a", no_end, now).is_known);
    CHECK(guard.admit("a", no_end, now).is_known);
    now += 1s;
    CHECK(ask("a", 1) == Waits{2'000});
    CHECK(guard.admit("a", no_end, now).is_known);
    now += 20s;
    CHECK(ask("a", 3) == Waits{0, 0, 0});
    fail("a", 4);
    static_cast<void>(ask("a", 3));
    CHECK_FALSE(guard.admit("a", no_end, now).is_known);
}

TEST_CASE_METHOD(Guarded, "the table is bounded, and the least recently seen goes")
{
    fail("a", 2);
    for (int i = 0; i < 1'000; ++i) {
        now += 1ms;
        static_cast<void>(ask(std::to_string(i), 1));
        if (i < 500) {
            static_cast<void>(ask("a", 1));
        }
        CHECK(guard.size() <= 4);
    }
    now += 1ms;
    CHECK(ask("a", 3) == Waits{0, 0, 0}); // forgotten
}

TEST_CASE_METHOD(Guarded, "intervals of nothing ration nothing")
{
    limits.channel_interval = 0ms;
    CHECK(ask("a", 100) == Waits(100, 0));
    fail("a", 100);
    CHECK(ask("a", 2) == Waits{0, 1'000});
    limits.failed_channel_interval = 0ms;
    CHECK(ask("b", 100) == Waits(100, 0));
    fail("b", 100);
    CHECK(ask("b", 100) == Waits(100, 0));
}

TEST_CASE_METHOD(Guarded, "hosts of one IPv6 network are one source, IPv4 addresses are each one")
{
    const auto wait = [&](std::string_view address) {
        ConnectionGate gate{guard, limits, address};
        return gate.admit(false, no_end, now).wait;
    };
    for (const char* host : {"2001:db8:1:2::1", "2001:db8:1:2::2", "2001:db8:1:2:3:4:5:6"}) {
        CHECK(wait(host) == 0ms);
    }
    CHECK(wait("2001:db8:1:2::1") == 100ms);
    CHECK(wait("2001:db8:1:3::1") == 0ms);
    for (const char* host : {"192.0.2.1", "::ffff:192.0.2.1", "192.0.2.1"}) {
        CHECK(wait(host) == 0ms);
    }
    CHECK(wait("192.0.2.1") == 100ms);
    CHECK(wait("192.0.2.2") == 0ms);
}

TEST_CASE_METHOD(Guarded,
                 "renewals are held up by nobody else's faults, and rationed by themselves")
{
    limits.min_token_lifetime = 10s;
    ConnectionGate gate{guard, limits, "192.0.2.1"};
    fail("192.0.2.1", 10);
    static_cast<void>(ask("192.0.2.1", 10));
    SECTION("a client that renews in time never waits")
    {
        for (int i = 0; i < 100; ++i) {
            now += 7'500ms;
            CHECK(gate.admit(true, no_end, now).wait == 0ms);
        }
    }
    SECTION("one that does nothing else does")
    {
        std::vector<Duration> waits;
        for (int i = 0; i < 6; ++i) {
            const auto admission = gate.admit(true, no_end, now);
            CHECK(admission.is_admitted);
            waits.push_back(admission.wait);
        }
        CHECK(waits == std::vector<Duration>{0ms, 0ms, 0ms, 0ms, 2'500ms, 5s});
        ConnectionGate other{guard, limits, "192.0.2.1"};
        CHECK(other.admit(true, no_end, now).wait == 0ms);
    }
}

} // namespace channel_guard_test
