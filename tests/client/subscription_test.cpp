#include <catch2/catch.hpp>

#include "subscriber_fixture.hpp"

namespace subscription_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::DeliveryMode;
using Start = Subscriptions::SessionStart;
using Values = std::vector<std::int32_t>;

namespace {

/// One Subscription with one item, of which the initial value was delivered.
struct OneItem : SubscriberFixture {
    OneItem()
    {
        item_handle = add(subscription, item(level, 100));
        pass(200ms);
        CHECK(heard.take_values() == Values{1});
    }
    void change(std::int32_t value)
    {
        set(0, value);
        pass(100ms);
    }
    /// The server publishes what nobody gets.
    void lose_message(std::int32_t value)
    {
        set(0, value);
        for (int i = 0; i < 15; ++i) {
            advance(10ms);
        }
        requester.client().run();
    }

    NodeId level{add_variable("level", 1)};
    SubscriptionHandle subscription{subscriptions.create(fast(), heard.handlers()).value()};
    ItemHandle item_handle{0};
};

} // namespace

TEST_CASE_METHOD(OneItem, "Values of an item are delivered",
                 "[client][unit:Monitor Client Value Change]"
                 "[unit:Subscription Client Basic]")
{
    REQUIRE(heard.statuses.size() == 1);
    CHECK(heard.statuses[0] == std::pair{StatusCode{status::Good}, DeliveryMode::Publishing});
    CHECK(subscriptions.mode(subscription) == DeliveryMode::Publishing);
    CHECK(subscriptions.server_id(subscription) != 0);
    REQUIRE(heard.items.size() == 1);
    CHECK(heard.items[0].first == item_handle);
    CHECK(heard.items[0].second.status == status::Good);
    CHECK(heard.items[0].second.revised_queue_size == 100);
    change(2);
    change(3);
    CHECK(heard.take_values() == Values{2, 3});
    pass(10s);
    change(4);
    CHECK(heard.take_values() == Values{4});
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(OneItem, "Items are changed, disabled and removed",
                 "[client][unit:Monitor Client Modify]")
{
    auto settings = item(level, 7);
    settings.mode = MonitoringMode::Disabled;
    REQUIRE(subscriptions.modify_items(std::array{item_handle}, settings));
    settle();
    CHECK(heard.items.back().second.revised_queue_size == 7);
    change(2);
    CHECK(heard.take_values().empty());
    settings.mode = MonitoringMode::Reporting;
    REQUIRE(subscriptions.modify_items(std::array{item_handle}, settings));
    pass(200ms);
    CHECK(heard.take_values() == Values{2});
    REQUIRE(subscriptions.remove_items(std::array{item_handle}));
    change(3);
    CHECK(heard.take_values().empty());
    CHECK(subscriptions.remove_items(std::array{item_handle}).error() ==
          status::Bad_MonitoredItemIdInvalid);
}

TEST_CASE_METHOD(OneItem, "A Subscription is changed, paused and removed",
                 "[client][unit:Subscription Client Modify]")
{
    auto settings = fast();
    settings.is_publishing_enabled = false;
    REQUIRE(subscriptions.modify(subscription, settings));
    settle();
    change(2);
    CHECK(heard.take_values().empty());
    settings.is_publishing_enabled = true;
    REQUIRE(subscriptions.modify(subscription, settings));
    pass(200ms);
    CHECK(heard.take_values() == Values{2});
    REQUIRE(subscriptions.remove(subscription));
    change(3);
    CHECK(heard.take_values().empty());
    CHECK(subscriptions.remove(subscription).error() == status::Bad_SubscriptionIdInvalid);
    CHECK(subscriptions.add_items(subscription, {}).error() == status::Bad_SubscriptionIdInvalid);
    pass(60s);
    CHECK(requester.open_count() <= 2); // nothing is asked for any more
}

TEST_CASE_METHOD(SubscriberFixture, "Items that the server refuses are told, in their order",
                 "[client]")
{
    const NodeId level = add_variable("level", 1);
    const auto subscription = subscriptions.create(fast(), heard.handlers()).value();
    auto server_times = item(level);
    server_times.timestamps = TimestampsToReturn::Server;
    const auto handles =
        subscriptions.add_items(subscription, {item(level), item(NodeId{1, "none"}), server_times})
            .value();
    REQUIRE(handles.size() == 3);
    pass(200ms);
    std::map<ItemHandle, StatusCode> statuses;
    for (const auto& [handle, status] : heard.items) {
        statuses[handle] = status.status;
    }
    CHECK(statuses[handles[0]] == status::Good);
    CHECK(statuses[handles[1]] == status::Bad_NodeIdUnknown);
    CHECK(statuses[handles[2]] == status::Good);
    CHECK(heard.data.size() == 2);
}

TEST_CASE_METHOD(SubscriberFixture, "Many items are created in calls of the server's size",
                 "[client]")
{
    const NodeId level = add_variable("level", 1);
    requester.info.operation_limits.max_monitored_items_per_call = 70;
    const auto subscription = subscriptions.create(fast(), heard.handlers()).value();
    const std::vector<client::ItemSettings> wishes(1'000, item(level));
    REQUIRE(subscriptions.add_items(subscription, wishes));
    pass(300ms);
    CHECK(heard.items.size() == 1'000);
    CHECK(heard.data.size() == 1'000);
}

TEST_CASE_METHOD(OneItem, "What was under way when the connection broke is fetched",
                 "[client][unit:Subscription Client Republish]")
{
    for (const Start how : {Start::Resumed, Start::New}) {
        lose_message(2);
        cut();
        CHECK(subscriptions.mode(subscription) == DeliveryMode::None);
        set(0, 3);
        advance(300ms);
        const auto id = subscriptions.server_id(subscription);
        start_again(how);
        pass(300ms);
        CHECK(heard.take_values() == Values{2, 3});
        CHECK(subscriptions.server_id(subscription) == id);
        CHECK(heard.gaps.empty());
        change(1);
        CHECK(heard.take_values() == Values{1});
    }
}

TEST_CASE_METHOD(OneItem, "A Subscription that has ended is made anew, with one Gap", "[client]")
{
    const DateTime before = wall_clock.time;
    cut();
    set(0, 2);
    for (int i = 0; i < 600; ++i) {
        advance(100ms);
    }
    start_again(Start::New);
    pass(400ms);
    CHECK(heard.take_values() == Values{2});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_SubscriptionIdInvalid);
    CHECK(heard.gaps[0].from <= before);
    CHECK(heard.gaps[0].to > before);
    pass(1s);
    CHECK(heard.gaps.size() == 1);
}

} // namespace subscription_test
