#include <catch2/catch.hpp>

#include <cmath>

#include "subscription_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct SamplingFixture : SubscriptionFixture {
    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
};

} // namespace

TEST_CASE("each step is its own nearest interval")
{
    const auto policy = server::stepped_sampling();
    for (const auto step : policy.intervals) {
        CHECK(policy.revise(static_cast<double>(step.count()), 1s, false) == step);
        CHECK(policy.revise(-1, step, false) == step);
    }
    CHECK(policy.intervals.front() == 200ms);
    CHECK(policy.intervals.back() == 60s);
    CHECK(policy.revise(0, 1s, true) == 200ms); // scans are not followed
    CHECK(policy.overload_percent == 5);
}

TEST_CASE("the products' limits are those of their manuals")
{
    const auto module = server::rd81opc96_subscriptions();
    CHECK(module.max_subscriptions_per_session == 10);
    CHECK(module.max_subscriptions == 150);
    CHECK(module.max_items == 15'000);
    CHECK(module.max_queue_size == 10);
    CHECK(module.min_publishing_interval == 50ms);
    CHECK(module.min_keep_alive == 5s);
    CHECK(module.min_lifetime == 10s);
    for (const auto& controller : {server::nj501_subscriptions(), server::nx102_subscriptions()}) {
        CHECK(controller.max_subscriptions == 100);
        CHECK(controller.max_items == 2'000);
    }
}

TEST_CASE("no interval is shorter than the MinimumSamplingInterval")
{
    const server::SamplingPolicy any;
    const auto steps = server::stepped_sampling();
    CHECK(any.revise(50, 1s, false, 120) == 120ms);
    CHECK(any.revise(0, 1s, false, 120) == 120ms);
    CHECK(any.revise(-1, 80ms, false, 120) == 120ms);
    CHECK(any.revise(300, 1s, false, 120) == 300ms);
    CHECK(any.revise(1'000, 1s, false, 4'000'000) == 4'000s);
    CHECK(any.revise(0, 1s, true, 120) == Duration::zero()); // by exception
    CHECK(any.revise(50, 1s, true, 120) == 120ms);
    CHECK(steps.revise(250, 1s, false, 250) == 300ms);
    CHECK(steps.revise(200, 1s, false, 700'000) == 700s);
    for (const double none : {0.0, -1.0, -120.0, std::nan("")}) {
        CHECK(any.revise(50, 1s, false, none) == 50ms);
        CHECK(steps.revise(250, 1s, false, none) == 200ms);
    }
    CHECK(any.revise(50, 1s, false, INFINITY) == 365 * 24h);
}

TEST_CASE_METHOD(SamplingFixture, "an item is not sampled faster than its Variable allows")
{
    model::NewVariable variable;
    variable.value = Variant{1};
    variable.data_type = NodeId{0, id::Int32};
    variable.minimum_sampling_interval = 400;
    const NodeId slow = add_variable("slow", variable);
    auto item = item_request(slow);
    const auto made = monitor(client, id, item);
    CHECK(made.revised_sampling_interval == 400);
    item.item_to_monitor.attribute_id = 4; // DisplayName: the limit is the Value's
    CHECK(monitor(client, id, item).revised_sampling_interval == 50);
    ModifyMonitoredItemsRequest request;
    request.subscription_id = id;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.items_to_modify.resize(1);
    request.items_to_modify[0].monitored_item_id = made.monitored_item_id;
    request.items_to_modify[0].requested_parameters.sampling_interval = 10;
    const auto response = client.call<ModifyMonitoredItemsResponse>(request);
    REQUIRE(response);
    CHECK(response->results[0].revised_sampling_interval == 400);
}
