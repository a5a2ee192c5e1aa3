#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "item_fixture.hpp"
#include "support/slow_server.hpp"

namespace sampling_policy_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE("stepped sampling takes the nearest interval, of two the shorter")
{
    const auto policy = server::stepped_sampling();
    const auto revised = [&](double requested) {
        return policy.revise(requested, 4'600ms, false) / 1ms;
    };
    CHECK(policy.intervals.size() == 8 + 9 + 6);
    CHECK(revised(0) == 200);
    CHECK(revised(220) == 200);
    CHECK(revised(250) == 200);
    CHECK(revised(260) == 300);
    CHECK(revised(950) == 900);
    CHECK(revised(951) == 1'000);
    CHECK(revised(9'500) == 9'000);
    CHECK(revised(15'000) == 10'000);
    CHECK(revised(1e300) == 60'000);
    CHECK(revised(-1) == 5'000); // the publishing interval, corrected again
    CHECK(revised(std::nan("")) == 5'000);
}

TEST_CASE("any interval down to a limit is the default")
{
    const server::SamplingPolicy policy;
    CHECK(policy.revise(0, 1s, false) == 10ms);
    CHECK(policy.revise(0, 1s, true) == Duration::zero());
    CHECK(policy.revise(33.3, 1s, true) == 33'300us);
    CHECK(policy.revise(-5, 1s, true) == 1s);
    CHECK(policy.revise(std::nan(""), 1s, false) == 1s);
    CHECK(policy.revise(INFINITY, 1s, false) == 3'600s);
}

TEST_CASE("intervals, counts and queue sizes of any kind are revised")
{
    ItemFixture fixture;
    auto request = fixture.subscription_request();
    const auto revise = [&](double interval, std::uint32_t lifetime, std::uint32_t keep_alive) {
        request.requested_publishing_interval = interval;
        request.requested_lifetime_count = lifetime;
        request.requested_max_keep_alive_count = keep_alive;
        return fixture.client.call<CreateSubscriptionResponse>(request).value();
    };
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double odd : {0.0, -1.0, std::nan(""), -infinity}) {
        const auto response = revise(odd, 0, 0);
        CHECK(response.revised_publishing_interval == 10);
        CHECK(response.revised_max_keep_alive_count == 1);
        CHECK(response.revised_lifetime_count == 3);
    }
    const auto most = revise(1e300, UINT32_MAX, UINT32_MAX);
    CHECK(most.revised_publishing_interval == 3'600'000);
    CHECK(most.revised_max_keep_alive_count == 1);
    CHECK(most.revised_lifetime_count == 3);
    const auto fast = revise(10, UINT32_MAX, UINT32_MAX);
    CHECK(fast.revised_max_keep_alive_count == 360'000);
    CHECK(fast.revised_lifetime_count == 1'080'000);
    auto item = fixture.item_request(fixture.level);
    item.requested_parameters.queue_size = UINT32_MAX;
    CHECK(fixture.monitor(fixture.client, fixture.id, item).revised_queue_size == 10'000);
}

TEST_CASE("a real interval past the revised one by more than 5 % makes Good_Overload")
{
    ItemFixture fixture{server::rd81opc96_subscriptions()};
    const auto made =
        fixture.monitor(fixture.client, fixture.id, fixture.item_request(fixture.level));
    CHECK(made.revised_sampling_interval == 200);
    CHECK(fixture.server.sampling_state().smallest_revised_interval == 200ms);
    CHECK(fixture.next_data(fixture.client, 200ms).size() == 1);
    fixture.advance(210ms); // 5 %
    CHECK(fixture.server.sampling_state().smallest_actual_interval == 210ms);
    CHECK(fixture.next_data(fixture.client, 100ms).empty());
    fixture.advance(300ms);
    CHECK(fixture.server.sampling_state().smallest_actual_interval == 400ms);
    const auto data = fixture.next_data(fixture.client, 100ms);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{Variant{1}, status::Good_Overload});
}

} // namespace sampling_policy_test
