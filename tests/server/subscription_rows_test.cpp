#include <catch2/catch.hpp>

#include "one_subscription.hpp"

namespace subscription_rows_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

// Rows of the state table (Part 4, 5.14.1.2) that are about services.

TEST_CASE("row 18: ModifySubscription applies at once and resets the lifetime",
          "[unit:Subscription Basic]")
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

TEST_CASE("row 19: SetPublishingMode stops and starts what is published",
          "[unit:Subscription Basic]")
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

TEST_CASE("row 20: Republish of a message that is there; row 21: of one that is not",
          "[unit:Subscription Basic][unit:Subscription Retransmission Queue]")
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

TEST_CASE("row 23: a transfer to another session of the same user", "[unit:Subscription Transfer]")
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

namespace {

/// Anonymous users over channels that say which application they are.
struct SignedAnonymous : SubscriptionParts, ServerFixture {
    SignedAnonymous() : ServerFixture{config()} {}
    static server::ServerConfig config()
    {
        server::ServerConfig config = secure_config();
        for (server::EndpointConfig& endpoint : config.endpoints) {
            endpoint.allows_anonymous = true;
        }
        return config;
    }
    TestClient log_in(const channel::ApplicationIdentity& identity)
    {
        TestClient client = connect("Basic256Sha256", MessageSecurityMode::Sign, identity);
        CreateSessionRequest request = client.create_request();
        request.client_description.application_uri =
            String{identity.certificates.front().application_uri()};
        REQUIRE(client.create_session(std::move(request)));
        REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
        return client;
    }
};

} // namespace

TEST_CASE("row 23: of anonymous users the same application may take a Subscription over",
          "[unit:Subscription Transfer]")
{
    SignedAnonymous fixture;
    const auto other_identity = make_identity("other");
    auto old_client = fixture.log_in(client_identity());
    auto stranger = fixture.log_in(other_identity);
    auto new_client = fixture.log_in(client_identity());
    const auto created =
        old_client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request());
    REQUIRE(created);
    const std::uint32_t id = created->subscription_id;
    CHECK(SubscriptionFixture::transfer(stranger, id).status_code == status::Bad_UserAccessDenied);
    CHECK(SubscriptionFixture::transfer(new_client, id).status_code == status::Good);
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

TEST_CASE("row 25: DeleteSubscriptions of one's own, and the queued requests with the last one",
          "[unit:Subscription Basic]")
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

} // namespace subscription_rows_test
