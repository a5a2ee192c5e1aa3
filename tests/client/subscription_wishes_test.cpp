#include <catch2/catch.hpp>

#include <busbar/types/method.hpp>

#include "puppet_fixture.hpp"

namespace subscription_wishes_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::DeliveryMode;
using client::ItemSettings;
using Ids = Array<std::uint32_t>;
using Start = Subscriptions::SessionStart;
using Values = std::vector<std::int32_t>;

namespace {

/// What the user says to Subscriptions, and what a server gets of it.
struct WishFixture : PuppetFixture {
    /// Nothing that was said is for the server; it has two Publish requests from before.
    void check_silence()
    {
        settle();
        CHECK(requester.open_count() == 2);
    }
    /// The Subscription ends at the server and is made anew; how many items it has then.
    std::size_t items_made_anew()
    {
        pass(1s);
        publish_status(1, status::Bad_Timeout);
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
        reply(created(8));
        const auto request = requester.take<CreateMonitoredItemsRequest>();
        return request.items_to_create.size();
    }
};

} // namespace

TEST_CASE_METHOD(WishFixture, "Wishes for what there is not are refused, and nothing is sent",
                 "[client]")
{
    start(2);
    const ItemHandle none = items[1] + 1;
    CHECK(subscriptions.modify(subscription + 1, {}).error() == status::Bad_SubscriptionIdInvalid);
    CHECK(subscriptions.remove(subscription + 1).error() == status::Bad_SubscriptionIdInvalid);
    CHECK(subscriptions.add_items(subscription + 1, std::vector<ItemSettings>(1)).error() ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(subscriptions.mode(subscription + 1) == DeliveryMode::None);
    CHECK(subscriptions.server_id(subscription + 1) == 0);
    ItemSettings slower;
    slower.sampling_interval = 5s;
    // All of them or none.
    CHECK(subscriptions.modify_items(std::vector{items[0], none}, slower).error() ==
          status::Bad_MonitoredItemIdInvalid);
    CHECK(subscriptions.remove_items(std::vector{items[0], none}).error() ==
          status::Bad_MonitoredItemIdInvalid);
    CHECK(subscriptions.set_triggering(none, {items[0]}).error() ==
          status::Bad_MonitoredItemIdInvalid);
    CHECK(subscriptions.set_triggering(items[0], {items[1], none}).error() ==
          status::Bad_MonitoredItemIdInvalid);
    check_silence();
    publish(message(1));
    CHECK(heard.take_values() == Values{1});
}

TEST_CASE_METHOD(WishFixture, "Links lead to items of the same Subscription only", "[client]")
{
    start(1);
    const auto other = subscriptions.create({}, heard.handlers()).value();
    const auto far = subscriptions.add_items(other, std::vector<ItemSettings>(1)).value();
    CHECK(subscriptions.set_triggering(items[0], far).error() ==
          status::Bad_MonitoredItemIdInvalid);
}

TEST_CASE_METHOD(WishFixture, "Settings that Part 4 does not have are refused", "[client]")
{
    start(1);
    ItemSettings settings;
    StatusCode reason = status::Bad_MonitoringModeInvalid;
    SECTION("no such timestamps")
    {
        settings.timestamps = static_cast<TimestampsToReturn>(GENERATE(-1, 4));
        reason = status::Bad_TimestampsToReturnInvalid;
    }
    SECTION("no such mode")
    {
        settings.mode = static_cast<MonitoringMode>(GENERATE(-1, 3));
    }
    CHECK(subscriptions.add_items(subscription, {ItemSettings{}, settings}).error() == reason);
    CHECK(subscriptions.modify_items(items, settings).error() == reason);
    check_silence();
}

TEST_CASE("There are no more Subscriptions and items than the limits say", "[client]")
{
    PuppetRequester requester;
    client::SubscriberLimits limits;
    limits.max_subscriptions = 2;
    limits.max_items = 3;
    Subscriptions subscriptions{requester, limits};
    const auto first = subscriptions.create({}, {}).value();
    const auto second = subscriptions.create({}, {}).value();
    CHECK(subscriptions.create({}, {}).error() == status::Bad_TooManySubscriptions);
    const auto items = subscriptions.add_items(first, std::vector<ItemSettings>(2)).value();
    CHECK(subscriptions.add_items(second, std::vector<ItemSettings>(2)).error() ==
          status::Bad_TooManyMonitoredItems);
    // What is removed makes room.
    REQUIRE(subscriptions.remove_items(items));
    const auto others = subscriptions.add_items(second, std::vector<ItemSettings>(3));
    REQUIRE(others);
    REQUIRE(subscriptions.remove(second));
    CHECK(subscriptions.add_items(first, std::vector<ItemSettings>(3)));
    REQUIRE(subscriptions.remove(first)); // the items that were removed before are not again
    const auto third = subscriptions.create({}, {}).value();
    CHECK(subscriptions.create({}, {}));
    CHECK(subscriptions.add_items(third, std::vector<ItemSettings>(3)));
    CHECK(subscriptions.add_items(third, std::vector<ItemSettings>(1)).error() ==
          status::Bad_TooManyMonitoredItems);
    CHECK(subscriptions.modify_items(*others, {}).error() == status::Bad_MonitoredItemIdInvalid);
}

TEST_CASE_METHOD(WishFixture, "An item that is to be removed twice is removed once", "[client]")
{
    start(2);
    REQUIRE(subscriptions.remove_items(std::vector{items[0], items[1], items[0]}));
    settle();
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids == Ids{101, 102});
    reply(DeleteMonitoredItemsResponse{});
    check_silence();
}

TEST_CASE_METHOD(WishFixture, "Of many items that were removed nothing is left", "[client]")
{
    start(100);
    REQUIRE(subscriptions.remove_items(std::span{items}.first(70)));
    settle();
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids.size() == 70);
    reply(DeleteMonitoredItemsResponse{});
    CHECK(items_made_anew() == 30);
}

TEST_CASE_METHOD(WishFixture, "What is said while there is no session is sent in the next one",
                 "[client]")
{
    start(2);
    publish(message(1));
    subscriptions.session_lost();
    client::SubscriptionSettings calmer;
    calmer.priority = 9;
    REQUIRE(subscriptions.modify(subscription, calmer));
    REQUIRE(subscriptions.remove_items(std::vector{items[1]}));
    ItemSettings sampled;
    sampled.mode = MonitoringMode::Sampling;
    REQUIRE(subscriptions.modify_items(std::vector{items[0]}, sampled));
    CHECK(subscriptions.next_deadline() == no_deadline);
    subscriptions.session_started(Start::Resumed);
    settle();
    CHECK(requester.take<ModifySubscriptionRequest>().priority == 9);
    reply(ModifySubscriptionResponse{});
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids == Ids{102});
    reply(DeleteMonitoredItemsResponse{});
    const auto mode = requester.take<SetMonitoringModeRequest>();
    CHECK(mode.monitoring_mode == MonitoringMode::Sampling);
    CHECK(mode.monitored_item_ids == Ids{101});
}

TEST_CASE_METHOD(WishFixture, "Who wants to be told of nothing still has his Subscription",
                 "[client]")
{
    subscription = subscriptions.create({}, {}).value();
    items = subscriptions.add_items(subscription, std::vector<ItemSettings>(1)).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    make_items();
    // The server is told that all of it has come.
    std::vector<std::uint32_t> acknowledged;
    const auto keep = [&](const PublishRequest& request) {
        for (const auto& one : request.subscription_acknowledgements) {
            acknowledged.push_back(one.sequence_number);
        }
    };
    keep(publish(message(1)));
    EventNotificationList events;
    events.events.push_back({items[0], {}});
    NotificationMessage content{2, time_of(2), {}};
    content.notification_data.push_back(ExtensionObject::from(events));
    keep(publish(std::move(content)));
    keep(publish(message(4)));
    refuse_republish(3); // a Gap
    for (int i = 0; i < 4; ++i) {
        keep(publish({5, time_of(5), {}}));
    }
    CHECK(acknowledged == std::vector<std::uint32_t>{1, 2, 4});
    CHECK(requester.count<CallRequest>() == 0); // values that nobody is told of
}

TEST_CASE_METHOD(WishFixture, "Events are told in their order, and those of other items are not",
                 "[client]")
{
    start(2);
    const auto publish_events = [this](std::uint32_t number, std::vector<ItemHandle> from) {
        EventNotificationList list;
        for (std::size_t i = 0; i < from.size(); ++i) {
            list.events.push_back({from[i], {Variant{static_cast<std::int32_t>(i)}}});
        }
        NotificationMessage content{number, time_of(number), {}};
        content.notification_data.push_back(ExtensionObject::from(list));
        publish(std::move(content));
    };
    publish_events(1, {items[1], 0, items[0], items[1] + 1, items[1]});
    REQUIRE(heard.events.size() == 3);
    CHECK(heard.events[0].item == items[1]);
    CHECK(heard.events[1].item == items[0]);
    CHECK(heard.events[1].fields == Array<Variant>{Variant{2}});
    CHECK(heard.events[2].fields == Array<Variant>{Variant{4}});
    // Nor are they told to a Subscription that the item is none of.
    const auto other = subscriptions.create({}, heard.handlers()).value();
    const auto far = subscriptions.add_items(other, std::vector<ItemSettings>(1)).value();
    publish_events(2, far);
    CHECK(heard.events.size() == 3);
}

TEST_CASE_METHOD(WishFixture, "After its Subscription is removed no part of a message is told",
                 "[client]")
{
    auto handlers = heard.handlers();
    bool is_gap = false;
    const auto remove = [this] { REQUIRE(subscriptions.remove(subscription)); };
    SECTION("by who is told of values")
    {
        handlers.on_data = [&](std::span<const client::DataChange>) { remove(); };
    }
    SECTION("by who is told of a Gap")
    {
        is_gap = true;
        handlers.on_gap = [&](const client::Gap&) { remove(); };
    }
    subscription = subscriptions.create({}, handlers).value();
    items = subscriptions.add_items(subscription, std::vector<ItemSettings>(1)).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    make_items();
    NotificationMessage content = message(is_gap ? 2'000 : 1); // a leap
    EventNotificationList events;
    events.events.push_back({items[0], {}});
    content.notification_data.push_back(ExtensionObject::from(events));
    content.notification_data.push_back(content.notification_data[0]);
    content.notification_data.push_back(ExtensionObject{});
    publish(std::move(content));
    CHECK(heard.data.empty());
    CHECK(heard.events.empty());
    CHECK(heard.gaps.empty());
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids == Ids{server_id});
    CHECK(subscriptions.mode(subscription) == DeliveryMode::None);
}

} // namespace subscription_wishes_test
