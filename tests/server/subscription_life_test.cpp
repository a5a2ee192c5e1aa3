#include <catch2/catch.hpp>

#include <map>
#include <memory>
#include <set>
#include <vector>

#include "subscription_fixture.hpp"
#include "support/slow_server.hpp"

namespace subscription_life_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 100ms;
const auto signed_channel = setting("Basic256Sha256", MessageSecurityMode::Sign);

StatusCode close(TestClient& client, bool deletes_subscriptions)
{
    CloseSessionRequest request;
    request.delete_subscriptions = deletes_subscriptions;
    return client.status_of<CloseSessionResponse>(request);
}

/// A server whose variable "slow" has a source that takes its time.
struct SlowItems : SlowFixture {
    SlowItems() : client{log_in()}
    {
        id = client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
                 .value()
                 .subscription_id;
    }
    std::uint32_t monitor()
    {
        const auto made = SubscriptionFixture::monitor(
            client, id, SubscriptionFixture::item_request(NodeId{1, "slow"}));
        CHECK(made.status_code == status::Good);
        return made.monitored_item_id;
    }
    void answer()
    {
        source.answer();
        server.handle_completions(now);
    }
    /// The statuses of what a cycle brings.
    std::vector<DataValue> next(std::uint32_t request)
    {
        advance(cycle);
        std::vector<DataValue> values;
        if (const auto response = SubscriptionFixture::take(client, request)) {
            for (const auto& one : SubscriptionFixture::data(response->notification_message)) {
                values.push_back(one.value);
            }
        }
        return values;
    }

    TestClient client;
    std::uint32_t id{0};
};

} // namespace

TEST_CASE("a few Subscriptions of a session with one interval publish in one turn")
{
    SubscriptionFixture fixture; // which lets a session have five Publish requests
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in();
    std::vector<std::uint32_t> ids;
    for (int i = 0; i < 3; ++i) {
        ids.push_back(fixture.subscribe(client));
        fixture.monitor(client, ids.back(), fixture.item_request(level));
        fixture.advance(30ms);
    }
    std::vector<std::uint32_t> requests;
    for (int i = 0; i < 3; ++i) {
        requests.push_back(fixture.publish(client));
    }
    std::set<std::uint32_t> from;
    const auto take = [&] {
        while (!requests.empty()) {
            const auto response = SubscriptionFixture::take(client, requests.front());
            if (!response) {
                return;
            }
            from.insert(response->subscription_id);
            requests.erase(requests.begin());
        }
    };
    fixture.advance(9ms); // 99 ms after the first was created
    take();
    CHECK(from.empty());
    fixture.advance(1ms);
    take();
    CHECK(from == std::set{ids[0], ids[1]});
    fixture.advance(59ms); // the third is 99 ms old
    take();
    CHECK(requests.size() == 1);
    fixture.advance(1ms);
    take();
    CHECK(from.contains(ids[2]));
}

TEST_CASE("Subscriptions outlive their session for as long as their lifetime says")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in(signed_channel);
    const auto id = fixture.subscribe(client);
    fixture.monitor(client, id, fixture.item_request(level));
    SECTION("CloseSession deletes them if it says so")
    {
        CHECK(close(client, true) == status::Good);
        CHECK(fixture.server.subscription_count() == 0);
        CHECK(fixture.server.monitored_item_count() == 0);
    }
    SECTION("else they go on, and can be taken over")
    {
        CHECK(close(client, false) == status::Good);
        fixture.set(0, 2);
        for (int i = 0; i < 20; ++i) {
            fixture.advance(cycle);
        }
        CHECK(fixture.server.subscription_count() == 1);
        auto other = fixture.log_in(signed_channel);
        CHECK(fixture.transfer(other, id).status_code == status::Good);
        // It was late.
        const auto response = fixture.take(other, fixture.publish(other));
        REQUIRE(response);
        const auto data = fixture.data(response->notification_message);
        REQUIRE(data.size() == 1);
        CHECK(data[0].value == DataValue{Variant{2}});
    }
    SECTION("and end")
    {
        CHECK(close(client, false) == status::Good);
        for (int i = 0; i < 31; ++i) {
            fixture.advance(cycle);
        }
        CHECK(fixture.server.subscription_count() == 0);
        CHECK(fixture.server.monitored_item_count() == 0);
    }
}

TEST_CASE("what clients leave behind is limited")
{
    auto limits = SubscriptionFixture::small_limits();
    limits.max_subscriptions = 5;
    SubscriptionFixture fixture{limits};
    for (std::size_t i = 0; i < 10; ++i) {
        auto client = fixture.log_in();
        const auto made = client.call<CreateSubscriptionResponse>(fixture.subscription_request());
        CHECK(made); // the oldest give way
        CHECK(fixture.server.subscription_count() == std::min<std::size_t>(i + 1, 5));
        CHECK(close(client, false) == status::Good);
    }
    for (int i = 0; i < 31; ++i) {
        fixture.advance(cycle);
    }
    CHECK(fixture.server.subscription_count() == 0);
}

TEST_CASE("a client that goes leaves requests and Subscriptions in order")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 1);
    auto staying = std::make_unique<TestClient>(fixture.log_in());
    {
        auto client = fixture.log_in();
        const auto id = fixture.subscribe(client);
        fixture.monitor(client, id, fixture.item_request(level));
        fixture.publish(client);
        fixture.publish(client);
    } // the connection is gone, its requests with it
    for (int i = 0; i < 31; ++i) {
        fixture.advance(cycle);
    }
    CHECK(fixture.server.subscription_count() == 0);
    fixture.advance(60s); // and the session
    CHECK(fixture.status_of(*staying, fixture.publish(*staying)) == status::Bad_SessionIdInvalid);
}

TEST_CASE("Publish requests end with their timeout, by Cancel and with the session")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    client.timeout_hint = 50;
    const auto late = fixture.publish(client);
    client.timeout_hint = 0;
    const auto cancelled = fixture.publish(client);
    CancelRequest cancel;
    cancel.request_handle = client.last_handle;
    REQUIRE(client.call<CancelResponse>(cancel));
    const auto waiting = fixture.publish(client);
    const auto last = fixture.publish(client);
    CHECK(fixture.status_of(client, cancelled) == status::Bad_RequestCancelledByClient);
    fixture.advance(60ms, client);
    CHECK(fixture.status_of(client, late) == status::Bad_Timeout);
    fixture.monitor(client, id, fixture.item_request(level));
    fixture.advance(cycle, client);
    const auto response = fixture.take(client, waiting);
    REQUIRE(response);
    CHECK(fixture.data(response->notification_message).size() == 1);
    CHECK(close(client, true) == status::Good);
    CHECK(fixture.status_of(client, last) == status::Bad_SessionClosed);
}

TEST_CASE("a Publish request that has timed out is not used, whoever notices it first")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    fixture.monitor(client, id, fixture.item_request(level));
    client.timeout_hint = 50;
    const auto late = fixture.publish(client);
    client.timeout_hint = 0;
    const auto waiting = fixture.publish(client);
    fixture.advance(cycle); // time has not passed for the connection yet
    CHECK(fixture.status_of(client, late) == status::Bad_Timeout);
    const auto response = fixture.take(client, waiting);
    REQUIRE(response);
    CHECK(fixture.data(response->notification_message).size() == 1);
}

TEST_CASE("the highest priority is served first, then the one that waits longest",
          "[unit:Subscription Minimum 02][unit:Subscription Multiple]")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in();
    std::vector<std::uint32_t> ids;
    for (const int priority : {1, 9, 1}) {
        auto request = fixture.subscription_request();
        request.priority = static_cast<std::uint8_t>(priority);
        ids.push_back(fixture.subscribe(client, request));
        fixture.monitor(client, ids.back(), fixture.item_request(level));
    }
    const auto served = [&] {
        const auto response = fixture.take(client, fixture.publish(client));
        return response ? response->subscription_id : 0;
    };
    fixture.advance(cycle);
    CHECK(served() == ids[1]);
    CHECK(served() == ids[0]);
    CHECK(served() == ids[2]);
    CHECK(served() == 0);
    // With one request for all three the timers go by priority too.
    fixture.set(0, 2);
    fixture.advance(cycle);
    client.run();
    REQUIRE(client.messages.size() == 1);
    const auto response = fixture.take(client, client.messages[0].request_id);
    REQUIRE(response);
    CHECK(response->subscription_id == ids[1]);
}

TEST_CASE("a Subscription that always has more to send leaves the others their turn")
{
    SubscriptionFixture fixture;
    auto client = fixture.log_in();
    auto request = fixture.subscription_request();
    request.max_notifications_per_publish = 1;
    const std::uint32_t busy = fixture.subscribe(client, request);
    const std::uint32_t calm = fixture.subscribe(client);
    for (const char* name : {"a", "b", "c"}) {
        fixture.monitor(client, busy, fixture.item_request(fixture.add_variable(name, 0)));
    }
    fixture.monitor(client, calm, fixture.item_request(fixture.add_variable("d", 0)));
    std::map<std::uint32_t, int> messages;
    for (int round = 1; round <= 20; ++round) {
        for (std::size_t variable = 0; variable < 4; ++variable) {
            fixture.set(variable, round);
        }
        fixture.advance(cycle);
        const auto response = fixture.take(client, fixture.publish(client));
        REQUIRE(response);
        ++messages[response->subscription_id];
    }
    CHECK(messages[busy] == 10);
    CHECK(messages[calm] == 10);
}

TEST_CASE("an item that always has more to send leaves the others of its Subscription their turn")
{
    SubscriptionFixture fixture;
    auto client = fixture.log_in();
    auto request = fixture.subscription_request();
    request.max_notifications_per_publish = 1;
    const std::uint32_t id = fixture.subscribe(client, request);
    for (const std::uint32_t handle : {1U, 2U}) {
        auto item = fixture.item_request(
            fixture.add_variable(("v" + std::to_string(handle)).c_str(), 0), handle);
        item.requested_parameters.queue_size = 5;
        fixture.monitor(client, id, item);
    }
    std::map<std::uint32_t, int> notifications;
    for (int round = 1; round <= 20; ++round) {
        for (const int half : {0, 1}) {
            fixture.set(0, 2 * round + half);
            fixture.set(1, 2 * round + half);
            fixture.advance(cycle / 2);
        }
        const auto response = fixture.take(client, fixture.publish(client));
        REQUIRE(response);
        const auto& data = response->notification_message.notification_data;
        REQUIRE(data.size() == 1);
        const auto* const changes = data[0].get_if<DataChangeNotification>();
        REQUIRE(changes != nullptr);
        REQUIRE(changes->monitored_items.size() == 1);
        ++notifications[changes->monitored_items[0].client_handle];
    }
    CHECK(notifications[1] == 10);
    CHECK(notifications[2] == 10);
}

TEST_CASE("a source that takes its time, is late or dies, and items that go meanwhile")
{
    SlowItems fixture;
    const auto item = fixture.monitor();
    const auto request = SubscriptionFixture::publish(fixture.client);
    REQUIRE(fixture.source.batches.size() == 1);
    SECTION("the value comes when it comes")
    {
        fixture.answer();
        CHECK(fixture.next(request) == std::vector<DataValue>{Variant{42}});
    }
    SECTION("an item whose value is still on its way is not asked for again")
    {
        fixture.advance(50ms);
        fixture.advance(50ms);
        CHECK(fixture.source.batches.size() == 1);
    }
    SECTION("an item that is made meanwhile keeps no other from being asked for")
    {
        fixture.answer();
        fixture.monitor();
        CHECK(fixture.source.batches.size() == 1); // its first value takes time
        fixture.advance(50ms);
        CHECK(fixture.source.batches.size() == 2);
    }
    SECTION("a late source is Bad_Timeout, and may answer then")
    {
        fixture.advance(5s);
        CHECK(fixture.next(request) == std::vector<DataValue>{status::Bad_Timeout});
        fixture.answer();
    }
    SECTION("a batch that is dropped is Bad_NoCommunication")
    {
        fixture.source.batches.clear();
        fixture.server.handle_completions(fixture.now);
        CHECK(fixture.next(request) == std::vector<DataValue>{status::Bad_NoCommunication});
    }
    SECTION("the item is deleted, others come, and then the value is there")
    {
        DeleteMonitoredItemsRequest remove;
        remove.subscription_id = fixture.id;
        remove.monitored_item_ids = {item};
        REQUIRE(fixture.client.call<DeleteMonitoredItemsResponse>(remove));
        fixture.monitor();
        fixture.monitor();
        REQUIRE(fixture.source.batches.size() == 3);
        for (int i = 0; i < 3; ++i) {
            fixture.answer();
        }
        CHECK(fixture.next(request).size() == 2);
    }
    SECTION("the Subscription is deleted, then the session, then the value is there")
    {
        CHECK(SubscriptionFixture::remove(fixture.client, fixture.id) == status::Good);
        CHECK(close(fixture.client, true) == status::Good);
        fixture.answer();
        fixture.advance(10s);
    }
}

} // namespace subscription_life_test
