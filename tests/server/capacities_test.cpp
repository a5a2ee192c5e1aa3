#include <catch2/catch.hpp>

#include <algorithm>
#include <deque>

#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/view.hpp>

#include "subscription_fixture.hpp"

namespace capacities_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

/// The numbers that profiles ask for (Part 7), with the limits that a server has by default.
namespace {

server::SubscriptionLimits default_limits()
{
    return {};
}

/// In however many turns the server takes for it.
void add_items(SubscriptionFixture& fixture, TestClient& client, const NodeId& node,
               std::uint32_t count)
{
    CreateMonitoredItemsRequest request;
    request.subscription_id = fixture.subscribe(client);
    for (std::uint32_t i = 0; i < count; ++i) {
        request.items_to_create.push_back(fixture.item_request(node, i));
    }
    const std::uint32_t id = client.send(request);
    auto made = client.take<CreateMonitoredItemsResponse>(id);
    while (!made && client.connection.next_deadline() <= fixture.now) {
        client.connection.handle_deadline(fixture.now);
        made = client.take<CreateMonitoredItemsResponse>(id);
    }
    REQUIRE(made);
    REQUIRE(made->results.size() == count);
    for (const MonitoredItemCreateResult& result : made->results) {
        REQUIRE(result.status_code == status::Good);
    }
}

bool is_used(TestClient& client)
{
    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{0, id::Server_ServerStatus_State};
    request.nodes_to_read[0].attribute_id = 13;
    const auto response = client.call<ReadResponse>(request);
    return response && response->results[0].status.is_good();
}

} // namespace

TEST_CASE("fifty sessions have a channel each, and one more is left for discovery",
          "[unit:Session Minimum 1][unit:Session Minimum 2 Parallel]"
          "[unit:Session Minimum 50 Parallel][unit:Session Multiple]")
{
    ServerFixture fixture;
    std::deque<TestClient> clients;
    for (int i = 0; i < 50; ++i) {
        clients.push_back(fixture.log_in());
    }
    CHECK(fixture.server.session_count() == 50);
    auto stranger = fixture.connect();
    CHECK(stranger.call<GetEndpointsResponse>(GetEndpointsRequest{}));
    CHECK(std::all_of(clients.begin(), clients.end(), is_used));
}

TEST_CASE("a session has five Subscriptions, each with 500 items, and ten Publish requests",
          "[unit:Subscription Minimum 05][unit:Monitor Items 2]"
          "[unit:Monitor Items 10][unit:Monitor Items 100][unit:Monitor Items 500]"
          "[unit:Subscription Publish Basic][unit:Subscription Publish Min 02]"
          "[unit:Subscription Publish Min 05][unit:Subscription Publish Min 10]")
{
    SubscriptionFixture fixture{default_limits()};
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in();
    constexpr std::uint32_t items = 500;
    for (int i = 0; i < 5; ++i) {
        add_items(fixture, client, level, items);
    }
    CHECK(fixture.server.subscription_count() == 5);
    CHECK(fixture.server.monitored_item_count() == 5 * items);
    for (int i = 0; i < 10; ++i) {
        fixture.publish(client);
    }
    client.run();
    CHECK(client.messages.empty()); // all of them wait
    fixture.advance(100ms);
    client.run();
    CHECK(client.messages.size() == 5);
    fixture.set(0, 2);
    fixture.advance(100ms);
    client.run();
    CHECK(client.messages.size() == 10);
}

TEST_CASE("an item queues five values",
          "[unit:Monitor MinQueueSize_02][unit:Monitor MinQueueSize_05]")
{
    SubscriptionFixture fixture{default_limits()};
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in();
    const auto subscription = fixture.subscribe(client);
    auto item = fixture.item_request(level);
    item.requested_parameters.queue_size = 5;
    CHECK(fixture.monitor(client, subscription, item).revised_queue_size == 5);
    CHECK(fixture.set_publishing(client, subscription, false) == status::Good);
    for (const int value : {2, 3, 4, 5, 6}) {
        fixture.set(0, value);
        fixture.advance(50ms);
    }
    CHECK(fixture.set_publishing(client, subscription, true) == status::Good);
    const auto request = fixture.publish(client);
    fixture.advance(100ms);
    const auto response = fixture.take(client, request);
    REQUIRE(response);
    const auto& data = response->notification_message.notification_data;
    REQUIRE(data.size() == 1);
    const auto* changes = data[0].get_if<DataChangeNotification>();
    REQUIRE(changes != nullptr);
    CHECK(changes->monitored_items.size() == 5);
}

TEST_CASE("a session has five continuation points", "[unit:View Minimum Continuation Point 05]")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    BrowseRequest request;
    request.requested_max_references_per_node = 1;
    request.nodes_to_browse.resize(5);
    for (BrowseDescription& what : request.nodes_to_browse) {
        what.node_id = NodeId{0, id::RootFolder};
        what.include_subtypes = true;
        what.result_mask = 63;
    }
    const auto begun = client.call<BrowseResponse>(request);
    REQUIRE(begun);
    BrowseNextRequest next;
    for (const BrowseResult& result : begun->results) {
        CHECK(result.status_code == status::Good);
        REQUIRE_FALSE(result.continuation_point.empty());
        next.continuation_points.push_back(result.continuation_point);
    }
    const auto gone_on = client.call<BrowseNextResponse>(next);
    REQUIRE(gone_on);
    for (const BrowseResult& result : gone_on->results) {
        CHECK(result.status_code == status::Good);
        CHECK(result.references.size() == 1);
    }
}

} // namespace capacities_test
