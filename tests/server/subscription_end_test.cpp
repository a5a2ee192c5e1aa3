#include <catch2/catch.hpp>

#include <algorithm>

#include "subscription_fixture.hpp"

namespace subscription_end_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t many = 1'000;

/// A Subscription with many items of one Variable.
struct EndFixture : SubscriptionFixture {
    explicit EndFixture(const server::SubscriptionLimits& limits = small_limits())
        : SubscriptionFixture{limits}, level{add_variable("level", 7)}, client{log_in()},
          subscription{fill(client)}
    {
    }
    std::uint32_t fill(TestClient& owner)
    {
        const std::uint32_t made = subscribe(owner);
        REQUIRE(create(owner, made, many) == many);
        return made;
    }
    /// How many of them could be made.
    std::size_t create(TestClient& owner, std::uint32_t in, std::size_t count) const
    {
        constexpr std::size_t items_of_turn = 20;
        std::size_t made = 0;
        for (std::size_t asked = 0; asked < count; asked += items_of_turn) {
            CreateMonitoredItemsRequest request;
            request.subscription_id = in;
            request.timestamps_to_return = TimestampsToReturn::Neither;
            request.items_to_create.resize(std::min(count - asked, items_of_turn));
            std::fill(request.items_to_create.begin(), request.items_to_create.end(),
                      item_request(level));
            const auto response = owner.call<CreateMonitoredItemsResponse>(request);
            REQUIRE(response);
            for (const auto& each : response->results) {
                made += each.status_code.is_good() ? 1U : 0U;
            }
        }
        return made;
    }
    /// How often the server had to be called until all was done that is due.
    std::size_t settle()
    {
        std::size_t calls = 0;
        for (; server.next_deadline() <= now; ++calls) {
            REQUIRE(calls < many);
            server.handle_deadline(now);
        }
        return calls;
    }

    NodeId level;
    TestClient client;
    std::uint32_t subscription;
};

} // namespace

TEST_CASE_METHOD(EndFixture, "the items of a Subscription that is deleted go a few at a time")
{
    settle();
    REQUIRE(server.monitored_item_count() == many);
    SECTION("by its id")
    {
        CHECK(remove(client, subscription) == status::Good);
    }
    SECTION("with its session")
    {
        CloseSessionRequest request;
        request.delete_subscriptions = true;
        CHECK(client.call<CloseSessionResponse>(request));
    }
    CHECK(server.subscription_count() == 0);
    CHECK(server.monitored_item_count() > many / 2);
    CHECK(settle() > 2);
    CHECK(server.monitored_item_count() == 0);
}

TEST_CASE_METHOD(EndFixture, "so do those of one whose lifetime is over")
{
    settle();
    CloseSessionRequest request;
    CHECK(client.call<CloseSessionResponse>(request));
    REQUIRE(server.subscription_count() == 1);
    std::size_t calls = 0;
    for (; server.subscription_count() != 0; now += 50ms) {
        REQUIRE(++calls < 1'000);
        server.handle_deadline(now);
    }
    CHECK(server.monitored_item_count() > many / 2);
    settle();
    CHECK(server.monitored_item_count() == 0);
}

TEST_CASE("items that are about to go take no room from new ones")
{
    server::SubscriptionLimits limits = SubscriptionFixture::small_limits();
    SECTION("in their number")
    {
        limits.max_items = many;
    }
    SECTION("in their memory")
    {
        limits.max_memory = std::size_t{2} << 20U;
    }
    limits.max_subscription_memory = std::size_t{4} << 20U;
    EndFixture fixture{limits};
    const std::uint32_t other = fixture.subscribe(fixture.client);
    const std::size_t more = fixture.create(fixture.client, other, 10'000);
    REQUIRE(fixture.create(fixture.client, other, 1) == 0);
    CHECK(fixture.remove(fixture.client, fixture.subscription) == status::Good);
    REQUIRE(fixture.server.monitored_item_count() > many / 2 + more);
    CHECK(fixture.create(fixture.client, other, many) == many);
    CHECK(fixture.create(fixture.client, other, 1) == 0);
}

TEST_CASE_METHOD(EndFixture, "nobody hears of items whose Subscription is deleted")
{
    settle();
    TestClient other = log_in();
    const std::uint32_t kept = subscribe(other);
    monitor(other, kept, item_request(level, 5));
    CHECK(remove(client, subscription) == status::Good);
    set(0, 8);
    CHECK(server.monitored_item_count() > many / 2);
    SECTION("after their session has ended")
    {
        CHECK(client.call<CloseSessionResponse>(CloseSessionRequest{}));
    }
    SECTION("after their Variable was removed")
    {
        CHECK(server.address_space().remove(server.address_space().find(level)));
    }
    SECTION("while another user logs in")
    {
        server.announce_access_change(now);
    }
    now += 100ms;
    settle();
    CHECK(server.monitored_item_count() == 1);
    CHECK(server.subscription_count() == 1);
}

} // namespace subscription_end_test
