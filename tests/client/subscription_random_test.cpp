#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "subscriber_fixture.hpp"

namespace subscription_random_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using Start = Subscriptions::SessionStart;

namespace {

/// A counter whose every value is queued, and a client whose connection breaks at any moment.
struct CutCounter : SubscriberFixture {
    explicit CutCounter(std::uint64_t seed) : SubscriberFixture{limits()}, engine_{seed}
    {
        auto handlers = heard.handlers();
        handlers.on_data = [this](std::span<const client::DataChange> changes) {
            for (const auto& change : changes) {
                check(change.value.value.value_or<std::int32_t>(-1));
            }
        };
        handlers.on_gap = [this](const client::Gap& gap) {
            ++gap_count;
            is_in_gap_ = true;
            gap_ = gap;
        };
        subscription = subscriptions.create(fast(), handlers).value();
        add(subscription, item(counter, 1'000));
        pass(300ms); // the first value is there, from now on nothing may be lost
    }
    [[nodiscard]] static server::SubscriptionLimits limits()
    {
        server::SubscriptionLimits limits = server_limits();
        limits.max_retransmission_messages = 12;
        return limits;
    }

    void run(Duration time)
    {
        for (; time > Duration{0}; time -= 10ms) {
            advance(10ms);
            // More than one sampling interval apart, so that each is sampled.
            if (now >= next_value_at_ && below(3) == 0) {
                next_value_at_ = now + 60ms;
                times_.push_back(wall_clock.time);
                set(0, static_cast<std::int32_t>(times_.size()));
            }
            if (requester.is_open()) {
                work();
            } else if (now >= back_at_) {
                start_again(below(2) == 0 ? Start::New : Start::Resumed);
            }
        }
    }
    void finish()
    {
        if (!requester.is_open()) {
            start_again(Start::New);
        }
        pass(2s);
        CHECK(last_ == static_cast<std::int32_t>(times_.size()));
    }

    SubscriptionHandle subscription{0};
    int gap_count{0};
    int cut_count{0};
    std::size_t value_count{0};

private:
    std::size_t below(std::size_t count) { return engine_() % count; }
    void work()
    {
        requester.time = now;
        requester.expire();
        const bool breaks = below(120) == 0;
        if (breaks && below(2) == 0) {
            requester.client().run(); // what the server sends now is lost
        } else {
            settle();
        }
        if (breaks) {
            ++cut_count;
            cut();
            // Seldom longer than the Subscription lives.
            back_at_ = now + std::chrono::milliseconds{below(8) == 0 ? 12'000 : below(3'000)};
        }
    }
    /// Every value comes once and in order, or was set within a Gap.
    void check(std::int32_t value)
    {
        ++value_count;
        if (value == last_ + 1) {
            last_ = value;
            return;
        }
        INFO("value " << value << " after " << last_);
        // A Subscription that was made anew begins with the value that is there.
        const bool is_initial = is_in_gap_ && value == last_;
        CHECK((value > last_ || is_initial));
        CHECK(is_in_gap_);
        for (std::int32_t lost = std::max(last_, 0) + 1; lost < value; ++lost) {
            const DateTime set_at = times_.at(static_cast<std::size_t>(lost - 1));
            CHECK(set_at <= gap_.to);
            // A value is published up to a sampling and a publishing interval after it was set.
            CHECK(set_at.ticks >= gap_.from.ticks - 2'000'000);
        }
        is_in_gap_ = false;
        last_ = value;
    }

    NodeId counter{add_variable("counter", 0)};
    std::mt19937_64 engine_;
    std::vector<DateTime> times_; // when each value was set
    std::int32_t last_{-1};
    bool is_in_gap_{false};
    client::Gap gap_;
    TimePoint back_at_{};
    TimePoint next_value_at_{};
};

} // namespace

TEST_CASE("Whatever breaks, every value comes once and in order, or lies in a Gap", "[client]")
{
    const char* given = std::getenv("BUSBAR_SUBSCRIPTION_SEED");
    const auto seed =
        given != nullptr ? std::strtoull(given, nullptr, 10) : GENERATE(1ULL, 2ULL, 3ULL, 4ULL);
    INFO("BUSBAR_SUBSCRIPTION_SEED=" << seed);
    CutCounter counter{seed};
    counter.run(3min);
    counter.finish();
    CHECK(counter.cut_count > 20);
    CHECK(counter.gap_count < counter.cut_count);
    CHECK(counter.value_count > 500);
}

} // namespace subscription_random_test
