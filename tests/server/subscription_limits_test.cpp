#include <catch2/catch.hpp>

#include "subscription_fixture.hpp"

namespace subscription_limits_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 100ms;

} // namespace

TEST_CASE("memory for items, queues and messages is limited")
{
    auto limits = SubscriptionFixture::small_limits();
    limits.max_subscription_memory = 20'000;
    SubscriptionFixture fixture{limits};
    const NodeId text = fixture.add_variable("text", Variant{"-"}, id::String);
    auto client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    auto item = fixture.item_request(text);
    item.requested_parameters.queue_size = 100;
    const auto made = fixture.monitor(client, id, item);
    CHECK(made.revised_queue_size == 100);
    auto greedy = item;
    greedy.requested_parameters.queue_size = 10'000;
    CHECK(fixture.monitor(client, id, greedy).revised_queue_size < 400);
    CHECK(fixture.monitor(client, id, item).status_code == status::Bad_TooManyMonitoredItems);

    // A value that nobody can pay for is told as such.
    fixture.set(0, Variant{String{std::string(30'000, 'x')}});
    fixture.advance(50ms);
    const auto data = fixture.next_data(client, cycle);
    REQUIRE_FALSE(data.empty());
    CHECK(data.back().value == DataValue{status::Bad_OutOfMemory});
    // All of it comes back.
    CHECK(fixture.remove(client, id) == status::Good);
    const auto again = fixture.subscribe(client);
    CHECK(fixture.monitor(client, again, item).revised_queue_size == 100);
}

TEST_CASE("messages stay within what the client takes")
{
    SubscriptionFixture fixture;
    const NodeId text =
        fixture.add_variable("text", Variant{String{std::string(3'000, 'x')}}, id::String);
    auto client = fixture.connect();
    auto create = client.create_request();
    create.max_response_message_size = 10'000;
    REQUIRE(client.create_session(create));
    REQUIRE(client.activate(client.anonymous()) == status::Good);
    const auto id = fixture.subscribe(client);
    for (std::uint32_t i = 0; i < 5; ++i) {
        fixture.monitor(client, id, fixture.item_request(text, i));
    }
    fixture.advance(cycle);
    std::vector<std::uint32_t> handles;
    for (bool has_more = true; has_more;) {
        const auto response = fixture.take(client, fixture.publish(client));
        REQUIRE(response);
        has_more = response->more_notifications;
        for (const auto& notification : fixture.data(response->notification_message)) {
            handles.push_back(notification.client_handle);
        }
    }
    CHECK(handles == std::vector<std::uint32_t>{0, 1, 2, 3, 4});
}

TEST_CASE("messages kept for Republish give way to newer ones",
          "[unit:Subscription Publish Discard Policy]"
          "[unit:Subscription Retransmission Queue]")
{
    auto limits = SubscriptionFixture::small_limits();
    limits.max_retransmission_messages = 3;
    SubscriptionFixture fixture{limits};
    const NodeId level = fixture.add_variable("level", 0);
    auto client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    fixture.monitor(client, id, fixture.item_request(level));
    Array<std::uint32_t> available;
    for (int i = 1; i <= 5; ++i) {
        const auto request = fixture.publish(client);
        fixture.set(0, i);
        fixture.advance(cycle);
        const auto response = fixture.take(client, request);
        REQUIRE(response);
        CHECK(response->notification_message.sequence_number == static_cast<std::uint32_t>(i));
        available = response->available_sequence_numbers;
    }
    CHECK(available == Array<std::uint32_t>{3, 4, 5});
    CHECK(fixture.republish(client, id, 2).error() == status::Bad_MessageNotAvailable);
    CHECK(fixture.republish(client, id, 3));
}

TEST_CASE("very many Publish requests: the oldest give way, and the server goes on",
          "[unit:Subscription PublishRequest Queue Overflow]"
          "[unit:Subscription Publish Discard Policy]")
{
    SubscriptionFixture fixture;
    auto client = fixture.log_in();
    fixture.subscribe(client);
    std::size_t refused = 0;
    for (int i = 0; i < 10'000; ++i) {
        fixture.publish(client);
        if (client.messages.size() >= 1'000) {
            refused += client.messages.size();
            client.messages.clear();
        }
    }
    refused += client.messages.size();
    client.messages.clear();
    CHECK(refused == 10'000 - 5);
    fixture.advance(cycle);
    client.run();
    CHECK(client.messages.size() == 1); // the first keep-alive
}

TEST_CASE("triggering links are limited, in circles too, and go with their items")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 0);
    auto client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    SetTriggeringRequest request;
    request.subscription_id = id;
    for (std::uint32_t i = 0; i < 300; ++i) {
        const auto made = fixture.monitor(client, id, fixture.item_request(level, i));
        request.links_to_add.push_back(made.monitored_item_id);
    }
    const Array<std::uint32_t> items = request.links_to_add;
    for (const std::uint32_t trigger : {items[0], items[1]}) { // both trigger themselves too
        request.triggering_item_id = trigger;
        const auto response = client.call<SetTriggeringResponse>(request);
        REQUIRE(response);
        CHECK(response->add_results[255] == status::Good);
        CHECK(response->add_results[256] == status::Bad_TooManyOperations);
    }
    fixture.set(0, 1);
    CHECK(fixture.next_data(client, cycle).size() == 300);
    DeleteMonitoredItemsRequest remove;
    remove.subscription_id = id;
    remove.monitored_item_ids = {items[0], items[5], items[1]};
    REQUIRE(client.call<DeleteMonitoredItemsResponse>(remove));
    fixture.set(0, 2);
    CHECK(fixture.next_data(client, cycle).size() == 297);
}

} // namespace subscription_limits_test
