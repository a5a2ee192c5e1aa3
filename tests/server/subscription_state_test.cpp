#include <catch2/catch.hpp>

#include <algorithm>

#include "one_subscription.hpp"
#include "server/subscription/state_table.hpp"

namespace subscription_state_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using server::detail::find_row;
using server::detail::SubscriptionEvent;
using server::detail::SubscriptionState;
using server::detail::SubscriptionVariables;

TEST_CASE("the table has all 27 rows, and one and only one for each situation")
{
    std::vector<unsigned> numbers;
    for (const auto& row : server::detail::subscription_rows()) {
        numbers.push_back(row.number);
    }
    std::sort(numbers.begin(), numbers.end());
    CHECK(std::count(numbers.begin(), numbers.end(), 9U) == 3); // for a counter that comes to 0
    REQUIRE(numbers.size() == 29);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    REQUIRE(numbers.size() == 27);
    CHECK(numbers.front() == 1);
    CHECK(std::adjacent_find(numbers.begin(), numbers.end(),
                             [](unsigned a, unsigned b) { return b != a + 1; }) == numbers.end());

    for (unsigned bits = 0; bits < 1U << 12U; ++bits) {
        const auto bit = [bits](unsigned i) { return (bits >> i & 1U) != 0; };
        SubscriptionVariables v;
        v.publishing_enabled = bit(0);
        v.publishing_req_queued = bit(1);
        v.more_notifications = bit(2);
        v.notifications_available = bit(3);
        v.message_sent = bit(4);
        v.keep_alive_counter = bit(5) ? 1 : 2;
        v.lifetime_counter = bit(6) ? 1 : 2;
        v.requested_message_found = bit(7);
        v.session_changed = bit(8);
        v.client_validated = bit(9);
        v.subscription_assigned_to_client = bit(10);
        v.max_keep_alive_count = bit(11) ? 1 : 2;
        for (const auto state :
             {SubscriptionState::Normal, SubscriptionState::Late, SubscriptionState::KeepAlive}) {
            for (const auto event :
                 {SubscriptionEvent::PublishRequest, SubscriptionEvent::PublishingTimer,
                  SubscriptionEvent::ModifySubscription, SubscriptionEvent::SetPublishingMode,
                  SubscriptionEvent::Republish, SubscriptionEvent::TransferSubscriptions,
                  SubscriptionEvent::DeleteSubscriptions}) {
                const auto rows = server::detail::subscription_rows();
                const auto matches = std::count_if(rows.begin(), rows.end(), [&](const auto& row) {
                    return row.event == event && row.states.has(state) && row.condition(v);
                });
                const bool ends =
                    event == SubscriptionEvent::PublishingTimer && v.lifetime_counter == 1;
                // Only row 27 comes on top of another, which it is tried before.
                const auto* row = find_row(state, event, v);
                REQUIRE(row != nullptr);
                REQUIRE(matches == (ends ? 2 : 1));
                REQUIRE((row->number == 27) == ends);
            }
        }
    }
}

TEST_CASE("row 1: CreateSubscription; row 3: it succeeds and the publishing timer runs",
          "[unit:Subscription Basic][unit:Subscription Minimum 1]")
{
    OneSubscription one;
    CHECK(one.server.next_deadline() == one.now + cycle);
    CHECK(one.id != 0);
}

TEST_CASE("row 2: CreateSubscription fails")
{
    auto limits = SubscriptionFixture::small_limits();
    limits.max_subscriptions_per_session = 1;
    SubscriptionFixture fixture{limits};
    auto client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    CHECK(client.status_of<CreateSubscriptionResponse>(fixture.subscription_request()) ==
          status::Bad_TooManySubscriptions);
    CHECK(fixture.remove(client, id) == status::Good);
    CHECK(client.status_of<CreateSubscriptionResponse>(fixture.subscription_request()) ==
          status::Good);
}

TEST_CASE("row 4: in NORMAL a Publish request is queued")
{
    OneSubscription one;
    one.add_item();
    const auto request = one.publish(one.client);
    CHECK(one.waits(request));
    one.advance(cycle - 1ns);
    CHECK(one.waits(request));
}

TEST_CASE("row 5: in NORMAL with more Notifications a Publish request is answered at once")
{
    OneSubscription one{one_at_a_time()};
    one.add_item();
    one.add_item();
    const auto first = one.publish(one.client);
    one.advance(cycle);
    const auto response = one.take(one.client, first);
    REQUIRE(response);
    CHECK(response->more_notifications);
    const auto second = one.publish(one.client);
    const auto rest = one.take(one.client, second);
    REQUIRE(rest);
    CHECK_FALSE(rest->more_notifications);
    CHECK(one.data(rest->notification_message).size() == 1);
    CHECK(rest->notification_message.sequence_number == 2);
}

TEST_CASE("row 4: what there was more of and has gone with its items is not sent")
{
    OneSubscription one{one_at_a_time()};
    one.add_item();
    const auto second = one.monitor(one.client, one.id, one.item_request(one.level));
    const auto first = one.publish(one.client);
    one.advance(cycle);
    CHECK(one.data_count(first) == 1);
    DeleteMonitoredItemsRequest remove;
    remove.subscription_id = one.id;
    remove.monitored_item_ids = {second.monitored_item_id};
    CHECK(one.client.status_of<DeleteMonitoredItemsResponse>(remove) == status::Good);
    const auto request = one.publish(one.client);
    CHECK(one.waits(request));
    // The sequence goes on without a gap.
    one.set(0, 2);
    one.advance(cycle);
    const auto response = one.take(one.client, request);
    REQUIRE(response);
    CHECK(response->notification_message.sequence_number == 2);
}

TEST_CASE("row 6: in NORMAL the timer sends Notifications with the queued request")
{
    OneSubscription one;
    one.add_item();
    const auto request = one.publish(one.client);
    one.advance(cycle);
    CHECK(one.data_count(request) == 1);
}

TEST_CASE("row 6: all queued requests are used while there are more Notifications")
{
    OneSubscription one{one_at_a_time()};
    one.add_item();
    one.add_item();
    const auto first = one.publish(one.client);
    const auto second = one.publish(one.client);
    const auto third = one.publish(one.client);
    one.advance(cycle);
    CHECK(one.data_count(first) == 1);
    CHECK(one.data_count(second) == 1);
    CHECK(one.waits(third));
}

TEST_CASE("row 7: the first timer sends a keep-alive if there is nothing else")
{
    OneSubscription one;
    const auto request = one.publish(one.client);
    one.advance(cycle);
    const auto response = one.take(one.client, request);
    REQUIRE(response);
    CHECK(response->notification_message.notification_data.empty());
    // That of the next message, and not kept.
    CHECK(response->notification_message.sequence_number == 1);
    CHECK(response->available_sequence_numbers.empty());
}

TEST_CASE("row 8: without a request the first message makes the Subscription late")
{
    OneSubscription one;
    one.add_item();
    one.advance(cycle);
    const auto request = one.publish(one.client);
    CHECK(one.data_count(request) == 1);
}

TEST_CASE("row 9: with a message sent and nothing to report KEEPALIVE begins")
{
    OneSubscription one;
    one.go_to_keep_alive();
    const auto request = one.publish(one.client);
    one.advance(cycle); // row 16
    CHECK(one.waits(request));
    one.advance(cycle); // row 15: the third cycle without a message
    CHECK(one.is_keep_alive(request));
}

TEST_CASE("row 9: a keep-alive count of 1 means one in each cycle without a message")
{
    auto request = SubscriptionFixture::subscription_request();
    request.requested_max_keep_alive_count = 1;
    OneSubscription one{request};
    one.add_item();
    const auto first = one.publish(one.client);
    one.advance(cycle);
    CHECK(one.data_count(first) == 1);
    SECTION("with a request")
    {
        for (int i = 0; i < 3; ++i) {
            const auto next = one.publish(one.client);
            one.advance(cycle);
            CHECK(one.is_keep_alive(next));
        }
    }
    SECTION("without one it is late")
    {
        one.advance(cycle);
        CHECK(one.is_keep_alive(one.publish(one.client)));
    }
}

TEST_CASE("row 10: in LATE a Publish request gets the Notifications, and NORMAL goes on")
{
    OneSubscription one;
    one.add_item();
    one.advance(cycle);
    CHECK(one.data_count(one.publish(one.client)) == 1);
    CHECK(one.waits(one.publish(one.client)));
}

TEST_CASE("row 11: in LATE with nothing to report a Publish request gets a keep-alive")
{
    OneSubscription one;
    one.advance(cycle);
    CHECK(one.is_keep_alive(one.publish(one.client)));
    // KEEPALIVE, counted anew.
    const auto request = one.publish(one.client);
    one.advance(cycle);
    one.advance(cycle);
    CHECK(one.waits(request));
    one.advance(cycle);
    CHECK(one.is_keep_alive(request));
}

TEST_CASE("row 12: in LATE the timer goes on")
{
    OneSubscription one;
    one.add_item();
    for (int i = 0; i < 20; ++i) {
        one.advance(cycle);
        CHECK(one.server.next_deadline() <= one.now + cycle);
    }
    CHECK(one.data_count(one.publish(one.client)) == 1);
}

TEST_CASE("row 13: in KEEPALIVE a Publish request is queued")
{
    OneSubscription one;
    one.go_to_keep_alive();
    one.add_item();
    CHECK(one.waits(one.publish(one.client)));
}

TEST_CASE("row 14: in KEEPALIVE the timer sends Notifications")
{
    OneSubscription one;
    one.go_to_keep_alive();
    one.add_item();
    const auto request = one.publish(one.client);
    one.advance(cycle);
    CHECK(one.data_count(request) == 1);
}

TEST_CASE("row 15: at the end of the keep-alive count a keep-alive is sent, again and again")
{
    OneSubscription one;
    one.go_to_keep_alive();
    const auto first = one.publish(one.client);
    one.advance(cycle);
    one.advance(cycle);
    CHECK(one.is_keep_alive(first));
    for (int i = 0; i < 3; ++i) {
        const auto request = one.publish(one.client);
        one.advance(cycle);
        one.advance(cycle);
        CHECK(one.waits(request));
        one.advance(cycle);
        CHECK(one.is_keep_alive(request));
    }
}

TEST_CASE("row 16: in KEEPALIVE the timer counts, also while publishing is disabled")
{
    OneSubscription one;
    one.go_to_keep_alive();
    one.add_item();
    CHECK(one.set_publishing(one.client, one.id, false) == status::Good);
    const auto request = one.publish(one.client);
    one.advance(cycle);
    CHECK(one.waits(request));
    one.advance(cycle);
    CHECK(one.is_keep_alive(request));
}

TEST_CASE("row 17: in KEEPALIVE without a request Notifications, or the count, make it late")
{
    OneSubscription one;
    one.go_to_keep_alive();
    SECTION("Notifications")
    {
        one.add_item();
        one.advance(cycle);
        CHECK(one.data_count(one.publish(one.client)) == 1);
    }
    SECTION("the count")
    {
        one.advance(cycle);
        one.advance(cycle);
        CHECK(one.is_keep_alive(one.publish(one.client)));
    }
}

} // namespace subscription_state_test
