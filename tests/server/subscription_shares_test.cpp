#include <catch2/catch.hpp>

#include "subscription_fixture.hpp"

namespace subscription_shares_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::string_view greedy_address = "192.0.2.66";

server::SubscriptionLimits few()
{
    auto limits = SubscriptionFixture::small_limits();
    limits.max_subscriptions_per_session = 10;
    limits.max_subscriptions_per_user = 10;
    limits.max_subscriptions = 10;
    return limits;
}

/// A server, and an anonymous user of another address who wants all there is.
struct SharesFixture : SubscriptionFixture {
    using SubscriptionFixture::SubscriptionFixture;

    TestClient log_in_from(std::string_view address)
    {
        TestClient client = connect({}, client_identity(), address);
        REQUIRE(client.open_session() == status::Good);
        return client;
    }
    static StatusCode try_to_subscribe(TestClient& client)
    {
        return client.status_of<CreateSubscriptionResponse>(subscription_request());
    }
    static StatusCode leave(TestClient& client)
    {
        CloseSessionRequest request;
        request.delete_subscriptions = false;
        return client.status_of<CloseSessionResponse>(request);
    }
    /// He subscribes so often, and goes.
    std::vector<std::uint32_t> leave_behind(int count, int items = 0)
    {
        const NodeId node = items == 0 ? NodeId{} : add_variable("greedy", 1);
        TestClient greedy = log_in_from(greedy_address);
        std::vector<std::uint32_t> ids;
        for (int i = 0; i < count; ++i) {
            ids.push_back(subscribe(greedy));
            for (int item = 0; item < items; ++item) {
                REQUIRE(monitor(greedy, ids.back(), item_request(node)).status_code.is_good());
            }
        }
        REQUIRE(leave(greedy) == status::Good);
        return ids;
    }
    /// How many lines of the log have this.
    [[nodiscard]] std::size_t lines_with(std::string_view text) const
    {
        std::size_t count = 0;
        for (std::size_t at = log.text.find(text); at != std::string::npos;
             at = log.text.find(text, at + 1)) {
            ++count;
        }
        return count;
    }
    [[nodiscard]] bool is_there(std::uint32_t id)
    {
        TestClient asking = log_in_from(greedy_address);
        return transfer(asking, id).status_code != status::Bad_SubscriptionIdInvalid;
    }
};

} // namespace

TEST_CASE("Subscriptions that were left behind keep nobody out, the oldest go first")
{
    SharesFixture fixture{few()};
    const auto left = fixture.leave_behind(10);
    auto client = fixture.log_in();
    for (int i = 0; i < 5; ++i) {
        CHECK(fixture.try_to_subscribe(client) == status::Good);
    }
    CHECK(fixture.server.subscription_count() == 10);
    CHECK_FALSE(fixture.is_there(left[0]));
    CHECK_FALSE(fixture.is_there(left[4]));
    CHECK(fixture.is_there(left[5]));
    CHECK(fixture.is_there(left[9]));
    // Both have five: whoever has as much takes nothing from others.
    CHECK(fixture.try_to_subscribe(client) == status::Bad_TooManySubscriptions);
    CHECK(fixture.lines_with("of an anonymous user from 192.0.2.66, whose client has gone, gives "
                             "way to an anonymous user from 192.0.2.1") == 1);
}

TEST_CASE("a user who has little keeps it")
{
    SharesFixture fixture{few()};
    auto modest = fixture.log_in();
    const auto kept = fixture.subscribe(modest);
    CHECK(fixture.leave(modest) == status::Good);
    fixture.leave_behind(9);
    auto other = fixture.log_in_from("192.0.2.3");
    for (int i = 0; i < 4; ++i) {
        CHECK(fixture.try_to_subscribe(other) == status::Good);
    }
    CHECK(fixture.is_there(kept));
}

TEST_CASE("a user has a share of the Subscriptions, over all sessions and addresses")
{
    auto limits = few();
    limits.max_subscriptions_per_user = 4;
    SharesFixture fixture{limits};
    auto first = fixture.log_in();
    auto second = fixture.log_in();
    for (int i = 0; i < 2; ++i) {
        CHECK(fixture.try_to_subscribe(first) == status::Good);
        CHECK(fixture.try_to_subscribe(second) == status::Good);
    }
    CHECK(fixture.try_to_subscribe(second) == status::Bad_TooManySubscriptions);
    SECTION("others have theirs")
    {
        auto other = fixture.log_in_from(greedy_address);
        CHECK(fixture.try_to_subscribe(other) == status::Good);
        auto user = fixture.log_in_as("operator"); // from the same address
        for (int i = 0; i < 4; ++i) {
            CHECK(fixture.try_to_subscribe(user) == status::Good);
        }
        auto same_user = fixture.log_in_as("operator");
        CHECK(fixture.try_to_subscribe(same_user) == status::Bad_TooManySubscriptions);
    }
    SECTION("what he deletes he may have again")
    {
        DeleteSubscriptionsRequest request;
        const auto id = second.call<CreateSubscriptionResponse>(fixture.subscription_request());
        CHECK_FALSE(id);
        CHECK(first.close_session() == status::Good);
        auto third = fixture.log_in();
        CHECK(fixture.server.subscription_count() == 4); // delete_subscriptions is false
        CHECK(fixture.try_to_subscribe(third) == status::Good);
        CHECK(fixture.server.subscription_count() == 4);
    }
}

TEST_CASE("a session without a channel gives way last, and is told")
{
    SharesFixture fixture{few()};
    auto greedy = std::make_unique<TestClient>(fixture.log_in_from(greedy_address));
    std::vector<std::uint32_t> ids;
    for (int i = 0; i < 8; ++i) {
        ids.push_back(fixture.subscribe(*greedy));
    }
    auto session =
        std::make_unique<TestClient>(fixture.connect({}, client_identity(), greedy_address));
    session->adopt(*greedy);
    greedy.reset(); // the connection
    auto leaving = fixture.log_in_from("192.0.2.5");
    fixture.subscribe(leaving);
    fixture.subscribe(leaving);
    CHECK(fixture.leave(leaving) == status::Good);

    auto client = fixture.log_in();
    CHECK(fixture.try_to_subscribe(client) == status::Good); // of who left
    CHECK(fixture.server.subscription_count() == 10);
    CHECK(fixture.try_to_subscribe(client) == status::Good); // of who has no channel
    REQUIRE(session->activate(session->anonymous()) == status::Good);
    const auto told = fixture.take(*session, fixture.publish(*session));
    REQUIRE(told);
    CHECK(told->subscription_id == ids[0]);
    CHECK(fixture.status_change(told->notification_message) == status::Bad_Timeout);
    // It is back: nothing of it gives way any more.
    CHECK(fixture.try_to_subscribe(client) == status::Bad_TooManySubscriptions);
}

TEST_CASE("items of Subscriptions that were left behind give way to others'")
{
    auto limits = few();
    limits.max_items = 40;
    limits.max_items_per_user = 40;
    SharesFixture fixture{limits};
    const auto left = fixture.leave_behind(2, 20);
    auto client = fixture.log_in();
    const NodeId level = fixture.add_variable("level", 1);
    const auto id = fixture.subscribe(client);
    for (int i = 0; i < 20; ++i) {
        CHECK(fixture.monitor(client, id, fixture.item_request(level)).status_code == status::Good);
    }
    CHECK_FALSE(fixture.is_there(left[0]));
    CHECK(fixture.is_there(left[1]));
    CHECK(fixture.server.monitored_item_count() == 40);
    CHECK(fixture.monitor(client, id, fixture.item_request(level)).status_code ==
          status::Bad_TooManyMonitoredItems);
}

TEST_CASE("a user has a share of the items")
{
    auto limits = few();
    limits.max_items_per_user = 3;
    SharesFixture fixture{limits};
    const NodeId level = fixture.add_variable("level", 1);
    auto client = fixture.log_in();
    const auto id = fixture.subscribe(client);
    const auto item = fixture.item_request(level);
    for (int i = 0; i < 3; ++i) {
        CHECK(fixture.monitor(client, id, item).status_code == status::Good);
    }
    CHECK(fixture.monitor(client, id, item).status_code == status::Bad_TooManyMonitoredItems);
    auto other = fixture.log_in_from(greedy_address);
    CHECK(fixture.monitor(other, fixture.subscribe(other), item).status_code == status::Good);
    CHECK(fixture.remove(client, id) == status::Good);
    CHECK(fixture.monitor(client, fixture.subscribe(client), item).status_code == status::Good);
}

} // namespace subscription_shares_test
