#include <catch2/catch.hpp>

#include <algorithm>

#include "server/subscription/state_table.hpp"
#include "subscription_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using server::detail::find_row;
using server::detail::SubscriptionEvent;
using server::detail::SubscriptionState;
using server::detail::SubscriptionVariables;

namespace {

constexpr Duration cycle = 100ms;

/// One client with one Subscription: a cycle of 100 ms, a keep-alive after 3, an end after 30.
struct OneSubscription : SubscriptionFixture {
    explicit OneSubscription(const CreateSubscriptionRequest& request = subscription_request())
        : level{add_variable("level", 1)}, client{log_in()}, id{subscribe(client, request)}
    {
    }
    void add_item() { CHECK(monitor(client, id, item_request(level)).status_code == status::Good); }
    /// Brings the Subscription from its first message to state KEEPALIVE, one cycle counted.
    void go_to_keep_alive()
    {
        const auto first = publish(client);
        advance(cycle);
        CHECK(take(client, first)); // row 7
        advance(cycle);             // row 9
    }
    [[nodiscard]] bool is_keep_alive(std::uint32_t request)
    {
        const auto response = take(client, request);
        return response && response->notification_message.notification_data.empty();
    }
    [[nodiscard]] std::size_t data_count(std::uint32_t request)
    {
        const auto response = take(client, request);
        return response ? data(response->notification_message).size() : 0;
    }
    [[nodiscard]] bool waits(std::uint32_t request)
    {
        return status_of(client, request) == status::Bad_WouldBlock;
    }

    NodeId level;
    TestClient client;
    std::uint32_t id;
};

CreateSubscriptionRequest one_at_a_time()
{
    auto request = SubscriptionFixture::subscription_request();
    request.max_notifications_per_publish = 1;
    return request;
}

} // namespace

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

TEST_CASE("row 1: CreateSubscription; row 3: it succeeds and the publishing timer runs")
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

TEST_CASE("row 18: ModifySubscription applies at once and resets the lifetime")
{
    OneSubscription one;
    one.advance(cycle * 25);
    ModifySubscriptionRequest request;
    request.subscription_id = one.id;
    request.requested_publishing_interval = 200;
    request.requested_lifetime_count = 6;
    request.requested_max_keep_alive_count = 2;
    const auto response = one.client.call<ModifySubscriptionResponse>(request);
    REQUIRE(response);
    CHECK(response->revised_publishing_interval == 200);
    CHECK(response->revised_lifetime_count == 6);
    CHECK(response->revised_max_keep_alive_count == 2);
    CHECK(one.server.next_deadline() == one.now + 200ms);
    for (int i = 0; i < 5; ++i) {
        one.advance(200ms);
    }
    CHECK(one.is_keep_alive(one.publish(one.client))); // it lives
}

TEST_CASE("row 19: SetPublishingMode stops and starts what is published")
{
    OneSubscription one{one_at_a_time()};
    one.add_item();
    one.add_item();
    const auto first = one.publish(one.client);
    one.advance(cycle);
    CHECK(one.data_count(first) == 1); // and there are more
    CHECK(one.set_publishing(one.client, one.id, false) == status::Good);
    const auto second = one.publish(one.client);
    CHECK(one.waits(second));
    CHECK(one.set_publishing(one.client, one.id, true) == status::Good);
    CHECK(one.waits(second)); // MoreNotifications is FALSE: at the next timer
    one.advance(cycle);
    CHECK(one.data_count(second) == 1);
}

TEST_CASE("row 20: Republish of a message that is there; row 21: of one that is not")
{
    OneSubscription one;
    one.add_item();
    const auto request = one.publish(one.client);
    one.advance(cycle);
    const auto response = one.take(one.client, request);
    REQUIRE(response);
    CHECK(response->available_sequence_numbers == Array<std::uint32_t>{1});
    const auto again = one.republish(one.client, one.id, 1);
    REQUIRE(again);
    CHECK(again->notification_message == response->notification_message);
    CHECK(one.republish(one.client, one.id, 2).error() == status::Bad_MessageNotAvailable);
    // Both are signs of life.
    one.advance(cycle);
    for (int i = 0; i < 28; ++i) {
        one.advance(cycle);
    }
    CHECK(one.republish(one.client, one.id, 2).error() == status::Bad_MessageNotAvailable);
    for (int i = 0; i < 28; ++i) {
        one.advance(cycle);
    }
    CHECK(one.republish(one.client, one.id, 1));
}

TEST_CASE("row 22: a transfer to the session that has it")
{
    OneSubscription one;
    CHECK(one.transfer(one.client, one.id).status_code == status::Bad_NothingToDo);
}

TEST_CASE("row 23: a transfer to another session of the same user")
{
    const auto secure = setting("Basic256Sha256", MessageSecurityMode::Sign);
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 1);
    auto old_client = fixture.log_in(secure);
    auto new_client = fixture.log_in(secure);
    const auto id = fixture.subscribe(old_client);
    CHECK(fixture.monitor(old_client, id, fixture.item_request(level)).status_code == status::Good);
    const auto first = fixture.publish(old_client);
    const auto second = fixture.publish(old_client);
    fixture.advance(cycle);
    CHECK(fixture.take(old_client, first));

    const auto result = fixture.transfer(new_client, id, true);
    CHECK(result.status_code == status::Good);
    CHECK(result.available_sequence_numbers == Array<std::uint32_t>{1});
    const auto told = fixture.take(old_client, second);
    REQUIRE(told);
    CHECK(told->subscription_id == id);
    CHECK(fixture.status_change(told->notification_message) ==
          status::Good_SubscriptionTransferred);
    CHECK(fixture.status_of(old_client, fixture.publish(old_client)) == status::Bad_NoSubscription);
    // With the initial values.
    const auto data = fixture.next_data(new_client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.value == Variant{1});
}

TEST_CASE("row 24: a transfer to another user is refused")
{
    OneSubscription one;
    auto other = one.log_in(); // anonymous, on a channel that proves nothing
    CHECK(one.transfer(other, one.id).status_code == status::Bad_UserAccessDenied);
    auto user = one.connect();
    REQUIRE(user.create_session());
    REQUIRE(user.activate(user.user("operator", "operator-secret")) == status::Good);
    CHECK(one.transfer(user, one.id).status_code == status::Bad_UserAccessDenied);
    // Nor after its session has gone.
    CloseSessionRequest close;
    close.delete_subscriptions = false;
    CHECK(one.client.status_of<CloseSessionResponse>(close) == status::Good);
    CHECK(one.transfer(other, one.id).status_code == status::Bad_UserAccessDenied);
    CHECK(one.transfer(user, one.id).status_code == status::Bad_UserAccessDenied);
}

TEST_CASE("row 25: DeleteSubscriptions of one's own, and the queued requests with the last one")
{
    OneSubscription one;
    const auto other = one.subscribe(one.client);
    const auto request = one.publish(one.client);
    CHECK(one.remove(one.client, one.id) == status::Good);
    CHECK(one.waits(request));
    CHECK(one.remove(one.client, other) == status::Good);
    CHECK(one.status_of(one.client, request) == status::Bad_NoSubscription);
    CHECK(one.remove(one.client, one.id) == status::Bad_SubscriptionIdInvalid);
}

TEST_CASE("row 26: DeleteSubscriptions of somebody else's")
{
    OneSubscription one;
    auto other = one.log_in();
    CHECK(one.remove(other, one.id) == status::Bad_SubscriptionIdInvalid);
    CHECK(one.remove(one.client, one.id) == status::Good);
}

TEST_CASE("row 27: at the end of its lifetime a Subscription is closed and its client told")
{
    OneSubscription one;
    one.add_item();
    for (int i = 0; i < 29; ++i) {
        one.advance(cycle);
    }
    CHECK(one.set_publishing(one.client, one.id, true) == status::Good); // still there
    for (int i = 0; i < 30; ++i) {
        one.advance(cycle);
    }
    CHECK(one.set_publishing(one.client, one.id, true) == status::Bad_SubscriptionIdInvalid);
    const auto request = one.publish(one.client);
    const auto response = one.take(one.client, request);
    REQUIRE(response);
    CHECK(response->subscription_id == one.id);
    CHECK(one.status_change(response->notification_message) == status::Bad_Timeout);
    CHECK(one.status_of(one.client, one.publish(one.client)) == status::Bad_NoSubscription);
}
