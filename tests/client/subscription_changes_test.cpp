#include <catch2/catch.hpp>

#include "puppet_fixture.hpp"

namespace subscription_changes_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ItemSettings;
using Ids = Array<std::uint32_t>;
using Start = Subscriptions::SessionStart;

namespace {

/// Items that change at a server that does not do what it is asked to.
struct ChangeFixture : PuppetFixture {
    void modify(std::span<const ItemHandle> changed, Duration interval = 5s)
    {
        ItemSettings settings;
        settings.sampling_interval = interval;
        REQUIRE(subscriptions.modify_items(changed, settings));
        settle();
    }
    void set_mode(std::span<const ItemHandle> changed, MonitoringMode mode)
    {
        ItemSettings settings;
        settings.mode = mode;
        REQUIRE(subscriptions.modify_items(changed, settings));
        settle();
    }
    void link(ItemHandle trigger, std::vector<ItemHandle> links)
    {
        REQUIRE(subscriptions.set_triggering(trigger, std::move(links)));
        settle();
    }
    /// Refuses every Request but the last of those that a client makes of one change.
    template <typename Request>
    void refuse_all_but_one(StatusCode status)
    {
        for (int i = 0; i < 3; ++i) {
            static_cast<void>(requester.take<Request>());
            refuse(status);
            CHECK(requester.count<Request>() == 0); // not at once
            CHECK(heard.items.empty());
            pass(4s);
        }
    }
    /// The items that were told of since the last call, all for the same reason.
    std::vector<ItemHandle> told(StatusCode reason)
    {
        std::vector<ItemHandle> handles;
        for (const auto& [handle, status] : std::exchange(heard.items, {})) {
            handles.push_back(handle);
            CHECK(status.status == reason);
        }
        return handles;
    }
    void start_quietly(std::uint32_t count)
    {
        start(count);
        heard.items.clear();
    }
};

[[nodiscard]] Ids modified(const ModifyMonitoredItemsRequest& request)
{
    Ids ids;
    for (const auto& item : request.items_to_modify) {
        ids.push_back(item.monitored_item_id);
    }
    return ids;
}

} // namespace

TEST_CASE_METHOD(ChangeFixture, "A change of items that keeps failing is told at last", "[client]")
{
    start_quietly(2);
    modify(items);
    refuse_all_but_one<ModifyMonitoredItemsRequest>(status::Bad_UserAccessDenied);
    CHECK(modified(requester.take<ModifyMonitoredItemsRequest>()) == Ids{101, 102});
    refuse(status::Bad_UserAccessDenied);
    CHECK(told(status::Bad_UserAccessDenied) == items);
    pass(60s);
    CHECK(requester.count<ModifyMonitoredItemsRequest>() == 0);
}

TEST_CASE_METHOD(ChangeFixture, "A change that went well leaves later ones all of their tries",
                 "[client]")
{
    start_quietly(1);
    modify(items);
    refuse_all_but_one<ModifyMonitoredItemsRequest>(status::Bad_UserAccessDenied);
    static_cast<void>(requester.take<ModifyMonitoredItemsRequest>());
    ModifyMonitoredItemsResponse response;
    response.results.push_back({status::Good, 5'000, 1, {}});
    reply(response);
    CHECK(told(status::Good) == items);

    modify(items, 6s);
    refuse_all_but_one<ModifyMonitoredItemsRequest>(status::Bad_UserAccessDenied);
    CHECK(requester.count<ModifyMonitoredItemsRequest>() == 1);
}

TEST_CASE_METHOD(ChangeFixture, "What the server says of changed items is told, of each its own",
                 "[client]")
{
    start_quietly(2);
    modify(items);
    static_cast<void>(requester.take<ModifyMonitoredItemsRequest>());
    SECTION("with a result for each")
    {
        ModifyMonitoredItemsResponse response;
        response.results.push_back({status::Good, 4'000, 2, {}});
        response.results.push_back({status::Bad_MonitoredItemIdInvalid, 0, 0, {}});
        reply(response);
        REQUIRE(heard.items.size() == 2);
        CHECK(heard.items[0].second.status == status::Good);
        CHECK(heard.items[0].second.revised_sampling_interval == 4'000);
        CHECK(heard.items[0].second.revised_queue_size == 2);
        CHECK(heard.items[1].first == items[1]);
        CHECK(heard.items[1].second.status == status::Bad_MonitoredItemIdInvalid);
    }
    SECTION("with too few results")
    {
        ModifyMonitoredItemsResponse response;
        response.results.resize(1);
        reply(response);
        CHECK(told(status::Bad_UnexpectedError) == items);
    }
    SECTION("with too many")
    {
        ModifyMonitoredItemsResponse response;
        response.results.resize(3);
        reply(response);
        CHECK(told(status::Bad_UnexpectedError) == items);
    }
    SECTION("but not of one that was removed meanwhile")
    {
        REQUIRE(subscriptions.remove_items(std::vector{items[0]}));
        ModifyMonitoredItemsResponse response;
        response.results.resize(2);
        reply(response);
        CHECK(told(status::Good) == std::vector{items[1]});
    }
}

TEST_CASE_METHOD(ChangeFixture, "Changes that are too large are made in parts", "[client]")
{
    start_quietly(5);
    modify(items);
    static_cast<void>(requester.take<ModifyMonitoredItemsRequest>());
    refuse(status::Bad_TooManyOperations);
    Ids ids;
    while (requester.count<ModifyMonitoredItemsRequest>() > 0) {
        const auto request = requester.take<ModifyMonitoredItemsRequest>();
        CHECK(request.items_to_modify.size() <= 2);
        for (const std::uint32_t id : modified(request)) {
            ids.push_back(id);
        }
        ModifyMonitoredItemsResponse response;
        response.results.resize(request.items_to_modify.size());
        reply(response);
    }
    CHECK(ids == Ids{101, 102, 103, 104, 105});
    CHECK(told(status::Good) == items);
}

TEST_CASE_METHOD(ChangeFixture, "A change that fails is not made again for what was removed",
                 "[client]")
{
    start_quietly(2);
    modify(items);
    static_cast<void>(requester.take<ModifyMonitoredItemsRequest>());
    REQUIRE(subscriptions.remove_items(std::vector{items[0]}));
    SECTION("as it is refused")
    {
        refuse(status::Bad_Timeout);
        pass(1s);
    }
    SECTION("as the connection breaks")
    {
        subscriptions.session_lost();
        subscriptions.session_started(Start::Resumed);
        settle();
    }
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids == Ids{101});
    reply(DeleteMonitoredItemsResponse{});
    CHECK(modified(requester.take<ModifyMonitoredItemsRequest>()) == Ids{102});
}

TEST_CASE_METHOD(ChangeFixture, "A change that finds no Subscription has it made anew", "[client]")
{
    start_quietly(2);
    modify(items, 7s);
    static_cast<void>(requester.take<ModifyMonitoredItemsRequest>());
    refuse(status::Bad_SubscriptionIdInvalid);
    CHECK(heard.statuses.back().first == status::Bad_SubscriptionIdInvalid);
    pass(1s);
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 0); // it is gone
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created(8));
    const auto request = requester.take<CreateMonitoredItemsRequest>();
    REQUIRE(request.items_to_create.size() == 2);
    CHECK(request.items_to_create[1].requested_parameters.sampling_interval == 7'000);
}

TEST_CASE_METHOD(ChangeFixture, "Modes that the server refuses are told", "[client]")
{
    start_quietly(3);
    set_mode(items, MonitoringMode::Disabled);
    SECTION("one by one")
    {
        const auto request = requester.take<SetMonitoringModeRequest>();
        CHECK(request.monitoring_mode == MonitoringMode::Disabled);
        CHECK(request.monitored_item_ids == Ids{101, 102, 103});
        SetMonitoringModeResponse response;
        response.results = {status::Good, status::Bad_MonitoredItemIdInvalid, status::Good};
        reply(response);
        CHECK(told(status::Bad_MonitoredItemIdInvalid) == std::vector{items[1]});
    }
    SECTION("all of them, after some tries")
    {
        refuse_all_but_one<SetMonitoringModeRequest>(status::Bad_UserAccessDenied);
        static_cast<void>(requester.take<SetMonitoringModeRequest>());
        refuse(status::Bad_UserAccessDenied);
        CHECK(told(status::Bad_UserAccessDenied) == items);
    }
    SECTION("with too few results")
    {
        static_cast<void>(requester.take<SetMonitoringModeRequest>());
        reply(SetMonitoringModeResponse{});
        CHECK(told(status::Bad_UnexpectedError) == items);
    }
    pass(60s);
    CHECK(requester.count<SetMonitoringModeRequest>() == 0);
}

TEST_CASE_METHOD(ChangeFixture, "A mode that failed to be set gives way to a later one", "[client]")
{
    start_quietly(2);
    set_mode(items, MonitoringMode::Disabled);
    static_cast<void>(requester.take<SetMonitoringModeRequest>());
    REQUIRE(subscriptions.remove_items(std::vector{items[0]}));
    set_mode(std::span{items}.last(1), MonitoringMode::Sampling);
    refuse(status::Bad_Timeout);
    pass(1s);
    static_cast<void>(requester.take<DeleteMonitoredItemsRequest>());
    reply(DeleteMonitoredItemsResponse{});
    const auto request = requester.take<SetMonitoringModeRequest>();
    CHECK(request.monitoring_mode == MonitoringMode::Sampling);
    CHECK(request.monitored_item_ids == Ids{102});
    SetMonitoringModeResponse response;
    response.results.resize(1);
    reply(response);
    CHECK(requester.count<SetMonitoringModeRequest>() == 0);
}

TEST_CASE_METHOD(ChangeFixture, "Items are deleted until the server says so", "[client]")
{
    requester.info.operation_limits.max_monitored_items_per_call = 2;
    subscription = subscriptions.create({}, heard.handlers()).value();
    items = subscriptions.add_items(subscription, std::vector<ItemSettings>(2)).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    make_items();
    const auto more = subscriptions.add_items(subscription, std::vector<ItemSettings>(1)).value();
    settle();
    CreateMonitoredItemsResponse third;
    third.results.push_back({status::Good, 103, 100, 1, {}});
    static_cast<void>(requester.take<CreateMonitoredItemsRequest>());
    reply(third);
    REQUIRE(subscriptions.remove_items(std::vector{items[0], items[1], more[0]}));
    settle();
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids == Ids{101, 102});
    refuse(status::Bad_Timeout);
    pass(1s);
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids == Ids{103, 101});
    reply(DeleteMonitoredItemsResponse{});
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids == Ids{102});
    // One that the server does not know is as good as deleted.
    DeleteMonitoredItemsResponse response;
    response.results = {status::Bad_MonitoredItemIdInvalid};
    reply(response);
    CHECK(requester.count<DeleteMonitoredItemsRequest>() == 0);
}

TEST_CASE_METHOD(ChangeFixture, "Links that the server refuses are told to the triggering item",
                 "[client]")
{
    start_quietly(3);
    link(items[0], {items[1], items[2]});
    SECTION("one of them")
    {
        CHECK(requester.take<SetTriggeringRequest>().links_to_add == Ids{102, 103});
        SetTriggeringResponse response;
        response.add_results = {status::Good, status::Bad_MonitoredItemIdInvalid};
        reply(response);
        CHECK(told(status::Bad_MonitoredItemIdInvalid) == std::vector{items[0]});
    }
    SECTION("all of them, after some tries")
    {
        refuse_all_but_one<SetTriggeringRequest>(status::Bad_ServiceUnsupported);
        CHECK(requester.take<SetTriggeringRequest>().links_to_add == Ids{102, 103});
        refuse(status::Bad_ServiceUnsupported);
        CHECK(told(status::Bad_ServiceUnsupported) == std::vector{items[0]});
    }
    pass(60s);
    CHECK(requester.count<SetTriggeringRequest>() == 0);
}

TEST_CASE_METHOD(ChangeFixture, "Links are made in calls of the server's size", "[client]")
{
    start_quietly(6);
    requester.info.operation_limits.max_monitored_items_per_call = 2;
    link(items[0], {items[5], items[1], items[2], items[3], items[2]});
    CHECK(requester.take<SetTriggeringRequest>().links_to_add == Ids{102, 103});
    reply(SetTriggeringResponse{});
    CHECK(requester.take<SetTriggeringRequest>().links_to_add == Ids{104, 106});
    reply(SetTriggeringResponse{});
    CHECK(requester.count<SetTriggeringRequest>() == 0);
    // Those that are to go come first.
    link(items[0], {items[4]});
    auto request = requester.take<SetTriggeringRequest>();
    CHECK(request.links_to_remove == Ids{102, 103});
    CHECK(request.links_to_add.empty());
    reply(SetTriggeringResponse{});
    request = requester.take<SetTriggeringRequest>();
    CHECK(request.links_to_remove == Ids{104, 106});
    reply(SetTriggeringResponse{});
    CHECK(requester.take<SetTriggeringRequest>().links_to_add == Ids{105});
    reply(SetTriggeringResponse{});
    CHECK(requester.count<SetTriggeringRequest>() == 0);
}

TEST_CASE_METHOD(ChangeFixture, "Links of items that are removed are forgotten", "[client]")
{
    start_quietly(3);
    link(items[0], {items[1], items[2]});
    SECTION("of the triggering item, before the answer")
    {
        static_cast<void>(requester.take<SetTriggeringRequest>());
        REQUIRE(subscriptions.remove_items(std::vector{items[0]}));
        if (GENERATE(true, false)) {
            refuse(status::Bad_Timeout);
        } else {
            SetTriggeringResponse response;
            response.add_results = {status::Bad_MonitoredItemIdInvalid};
            reply(response);
        }
        CHECK(heard.items.empty());
    }
    SECTION("of the triggering item, before they are sent")
    {
        REQUIRE(subscriptions.set_triggering(items[1], {items[2]}));
        REQUIRE(subscriptions.remove_items(std::vector{items[1]}));
        static_cast<void>(requester.take<SetTriggeringRequest>());
        reply(SetTriggeringResponse{});
    }
    SECTION("of an item that is triggered")
    {
        static_cast<void>(requester.take<SetTriggeringRequest>());
        reply(SetTriggeringResponse{});
        REQUIRE(subscriptions.remove_items(std::vector{items[1]}));
        settle();
        static_cast<void>(requester.take<DeleteMonitoredItemsRequest>());
        reply(DeleteMonitoredItemsResponse{});
        link(items[0], {items[2]}); // the server has dropped the other one
    }
    pass(60s);
    CHECK(requester.count<SetTriggeringRequest>() == 0);
}

} // namespace subscription_changes_test
