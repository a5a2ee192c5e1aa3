#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "event_item_fixture.hpp"
#include "one_subscription.hpp"

namespace subscription_attack_test {

// Subscriptions that change hands, lose their items or their client, while they have something to
// tell (tests/attacks.txt, F).

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const auto secure = setting("Basic256Sha256", MessageSecurityMode::Sign);

/// An item that is sampled with its Subscription's interval and keeps ten values.
MonitoredItemCreateRequest deep_item(const NodeId& node, std::uint32_t queue_size = 10)
{
    auto item = SubscriptionFixture::item_request(node);
    item.requested_parameters.sampling_interval = -1;
    item.requested_parameters.queue_size = queue_size;
    return item;
}

StatusCode delete_item(TestClient& client, std::uint32_t subscription, std::uint32_t item)
{
    DeleteMonitoredItemsRequest request;
    request.subscription_id = subscription;
    request.monitored_item_ids = {item};
    const auto response = client.call<DeleteMonitoredItemsResponse>(request);
    return response ? response->results[0] : response.error();
}

std::uint32_t resize_queue(TestClient& client, std::uint32_t subscription, std::uint32_t item,
                           const ExtensionObject& filter = {})
{
    ModifyMonitoredItemsRequest request;
    request.subscription_id = subscription;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.items_to_modify.resize(1);
    request.items_to_modify[0].monitored_item_id = item;
    request.items_to_modify[0].requested_parameters.queue_size = 1;
    request.items_to_modify[0].requested_parameters.sampling_interval = -1;
    request.items_to_modify[0].requested_parameters.discard_oldest = true;
    request.items_to_modify[0].requested_parameters.filter = filter;
    const auto response = client.call<ModifyMonitoredItemsResponse>(request);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Good);
    return response->results[0].revised_queue_size;
}

/// How many of each kind a message has.
std::pair<std::size_t, std::size_t> counts(const NotificationMessage& message)
{
    std::size_t data = 0;
    std::size_t events = 0;
    for (const ExtensionObject& part : message.notification_data) {
        if (const auto* changes = part.get_if<DataChangeNotification>()) {
            data += changes->monitored_items.size();
        }
        if (const auto* list = part.get_if<EventNotificationList>()) {
            events += list->events.size();
        }
    }
    return {data, events};
}

} // namespace

TEST_CASE("a Subscription that changed hands is deleted by its new session only", "[attack]")
{
    const bool new_first = GENERATE(true, false);
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 1);
    auto old_client = fixture.log_in(secure);
    auto new_client = fixture.log_in(secure);
    const auto id = fixture.subscribe(old_client);
    CHECK(fixture.monitor(old_client, id, deep_item(level)).status_code == status::Good);
    CHECK(fixture.next_data(old_client, cycle).size() == 1);
    fixture.publish(old_client);
    fixture.publish(new_client); // refused, as there is nothing to publish yet
    fixture.set(0, 2);
    CHECK(fixture.transfer(new_client, id).status_code == status::Good);
    if (new_first) {
        CHECK(fixture.remove(new_client, id) == status::Good);
        CHECK(fixture.remove(old_client, id) == status::Bad_SubscriptionIdInvalid);
    } else {
        CHECK(fixture.remove(old_client, id) == status::Bad_SubscriptionIdInvalid);
        fixture.advance(cycle);
        CHECK(fixture.remove(new_client, id) == status::Good);
        CHECK(fixture.remove(new_client, id) == status::Bad_SubscriptionIdInvalid);
    }
    fixture.set(0, 3);
    fixture.advance(10 * cycle);
    CHECK(fixture.server.subscription_count() == 0);
    CHECK(fixture.server.monitored_item_count() == 0);
    CHECK(fixture.transfer(old_client, id).status_code == status::Bad_SubscriptionIdInvalid);
    CHECK(old_client.close_session() == status::Good);
    CHECK(new_client.close_session() == status::Good);
}

TEST_CASE("what is deleted between its sample and its message is not told", "[attack]")
{
    OneSubscription one;
    const auto made = one.monitor(one.client, one.id, deep_item(one.level));
    CHECK(one.next_data(one.client, cycle).size() == 1);
    const auto waiting = one.publish(one.client);
    one.set(0, 2);
    one.advance(cycle - 1ms); // almost: what is sampled waits for the cycle's end
    SECTION("an item")
    {
        CHECK(delete_item(one.client, one.id, made.monitored_item_id) == status::Good);
        CHECK(delete_item(one.client, one.id, made.monitored_item_id) ==
              status::Bad_MonitoredItemIdInvalid);
        one.advance(4 * cycle);
        CHECK(one.data_count(waiting) == 0);
    }
    SECTION("its Subscription")
    {
        CHECK(one.remove(one.client, one.id) == status::Good);
        one.advance(4 * cycle);
        CHECK(one.status_of(one.client, waiting) == status::Bad_NoSubscription);
    }
    SECTION("its session")
    {
        CHECK(one.client.close_session() == status::Good);
        one.advance(4 * cycle);
        CHECK(one.status_of(one.client, waiting) == status::Bad_SessionClosed);
    }
    SECTION("its Variable")
    {
        auto& space = one.server.address_space();
        CHECK(space.remove(space.find(one.level)));
        one.advance(4 * cycle);
        CHECK(one.status_of(one.client, waiting) == status::Good);
    }
    one.advance(50 * cycle);
    auto other = one.log_in();
    CHECK(one.status_of(other, one.publish(other)) == status::Bad_NoSubscription);
}

TEST_CASE("a full queue of ten that becomes one keeps the newest value", "[attack]")
{
    OneSubscription one;
    const auto made = one.monitor(one.client, one.id, deep_item(one.level));
    CHECK(one.set_publishing(one.client, one.id, false) == status::Good);
    for (int value = 2; value < 20; ++value) {
        one.set(0, value);
        one.advance(cycle);
    }
    CHECK(resize_queue(one.client, one.id, made.monitored_item_id) == 1);
    CHECK(one.set_publishing(one.client, one.id, true) == status::Good);
    const auto data = one.next_data(one.client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.value == Variant{19});
}

TEST_CASE_METHOD(EventFixture, "a full queue of ten events that becomes one keeps the newest",
                 "[attack]")
{
    const auto made = monitor(client, id, event_request());
    for (int i = 0; i < 20; ++i) {
        raise(std::to_string(i).c_str());
    }
    CHECK(resize_queue(client, id, made.monitored_item_id,
                       ExtensionObject::from(selecting({"Message"}))) == 1);
    const auto messages = next_messages(client);
    REQUIRE_FALSE(messages.empty());
    CHECK(messages.size() <= 2); // with the one that tells of the lost ones
    CHECK(std::find(messages.begin(), messages.end(), "19") != messages.end());
}

TEST_CASE_METHOD(EventFixture, "a message with data and events is published and comes again",
                 "[attack]")
{
    const NodeId level = add_variable("level", 1);
    CHECK(monitor(client, id, item_request(level)).status_code == status::Good);
    CHECK(monitor(client, id, event_request()).status_code == status::Good);
    raise("one");
    raise("two");
    const auto request = publish(client);
    advance(cycle);
    const auto response = take(client, request);
    REQUIRE(response);
    const NotificationMessage& first = response->notification_message;
    CHECK(counts(first) == std::pair<std::size_t, std::size_t>{1, 2});
    for (int i = 0; i < 3; ++i) { // as often as it is asked for
        const auto again = republish(client, id, first.sequence_number);
        REQUIRE(again);
        CHECK(again->notification_message == first);
    }
    const auto acknowledging = publish(client, {{id, first.sequence_number}});
    set(0, 2);
    raise("three");
    advance(cycle);
    const auto next = take(client, acknowledging);
    REQUIRE(next);
    CHECK(next->results[0] == status::Good);
    CHECK(counts(next->notification_message) == std::pair<std::size_t, std::size_t>{1, 1});
    CHECK(republish(client, id, first.sequence_number).error() == status::Bad_MessageNotAvailable);
    CHECK(republish(client, id, 4'711).error() == status::Bad_MessageNotAvailable);
}

TEST_CASE("a client that takes nothing for longer than its Subscription lives loses it", "[attack]")
{
    OneSubscription one;
    one.add_item();
    for (int i = 0; i < 5; ++i) { // sent, and the answers never taken
        PublishRequest request;
        request.request_header.authentication_token = one.client.authentication_token;
        REQUIRE(one.client.channel.send([&](binary::Writer& writer) {
            encode(writer, NodeId{0, PublishRequest::binary_encoding_id});
            encode(writer, request);
        }));
    }
    carry(one.client.channel, one.client.connection, one.now);
    for (int i = 0; i < 200 && !one.client.is_closed(); ++i) {
        one.set(0, i);
        one.advance(10 * cycle);
        one.client.connection.handle_deadline(one.now);
    }
    CHECK(one.client.is_closed());
    for (int i = 0; i < 31; ++i) {
        one.advance(cycle);
    }
    CHECK(one.server.subscription_count() == 0);
    CHECK(one.server.monitored_item_count() == 0);
    auto other = one.log_in();
    CHECK(one.subscribe(other) != one.id);
}

} // namespace subscription_attack_test
