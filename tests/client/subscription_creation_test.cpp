#include <catch2/catch.hpp>

#include <limits>

#include <busbar/types/view.hpp>

#include "puppet_fixture.hpp"

namespace subscription_creation_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::DeliveryMode;
using client::ItemSettings;
using Ids = Array<std::uint32_t>;
using Start = Subscriptions::SessionStart;
using Values = std::vector<std::int32_t>;

namespace {

/// A Subscription and items that the server does not make as they are wanted.
struct CreationFixture : PuppetFixture {
    CreationFixture() { requester.info.namespaces = {"http://opcfoundation.org/UA/", "urn:plant"}; }
    void wish(std::vector<ItemSettings> wishes)
    {
        subscription = subscriptions.create({}, heard.handlers()).value();
        items = subscriptions.add_items(subscription, std::move(wishes)).value();
        settle();
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
    }
    void start_creation(std::uint32_t count)
    {
        wish(std::vector<ItemSettings>(count));
        reply(created());
    }
    [[nodiscard]] static ItemSettings at_path(const char* path)
    {
        ItemSettings settings;
        settings.node = client::NodeAddress::parse(path).value();
        return settings;
    }
    void enable(const SetPublishingModeResponse& response)
    {
        static_cast<void>(requester.take<SetPublishingModeRequest>());
        reply(response);
    }
    [[nodiscard]] StatusCode last_status() const { return heard.statuses.back().first; }
};

} // namespace

TEST_CASE_METHOD(CreationFixture, "A Subscription that the server refuses is asked for less often",
                 "[client]")
{
    subscription = subscriptions.create({}, heard.handlers()).value();
    settle();
    for (const auto pause : {1s, 2s, 4s, 8s, 16s, 32s, 32s}) {
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
        refuse(status::Bad_TooManySubscriptions);
        CHECK(heard.statuses.back() ==
              std::pair{StatusCode{status::Bad_TooManySubscriptions}, DeliveryMode::None});
        pass(pause - 1ms);
        CHECK(requester.count<CreateSubscriptionRequest>() == 0);
        pass(1ms);
    }
    CHECK(heard.statuses.size() == 7);
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    CHECK(last_status() == status::Good);
}

TEST_CASE_METHOD(CreationFixture, "A Subscription whose id is no id is not taken", "[client]")
{
    start();
    const auto second = subscriptions.create({}, heard.handlers()).value();
    settle();
    for (const std::uint32_t id : {0U, server_id}) {
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
        reply(created(id));
        CHECK(last_status() == status::Bad_SubscriptionIdInvalid);
        CHECK(subscriptions.server_id(second) == 0);
        CHECK(requester.count<CreateSubscriptionRequest>() == 0);
        pass(2s);
    }
    publish(message(1)); // the first one has not been disturbed
    CHECK(heard.take_values() == Values{1});
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 0);
}

TEST_CASE_METHOD(CreationFixture, "A Subscription that was removed before it was made is deleted",
                 "[client]")
{
    wish({ItemSettings{}});
    REQUIRE(subscriptions.remove(subscription));
    SECTION("once it is there")
    {
        reply(created());
        CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids == Ids{server_id});
        reply(DeleteSubscriptionsResponse{});
    }
    SECTION("unless it was not made")
    {
        refuse(status::Bad_TooManySubscriptions);
        pass(60s);
    }
    CHECK(requester.open_count() == 0);
    CHECK(heard.statuses.empty());
}

TEST_CASE_METHOD(CreationFixture, "Changed settings that the server refuses are told", "[client]")
{
    start();
    client::SubscriptionSettings slower;
    slower.publishing_interval = 2s;
    REQUIRE(subscriptions.modify(subscription, slower));
    settle();
    const auto request = requester.take<ModifySubscriptionRequest>();
    CHECK(request.subscription_id == server_id);
    CHECK(request.requested_publishing_interval == 2'000);
    const std::size_t told = heard.statuses.size();
    SECTION("after some tries")
    {
        for (int i = 0; i < 3; ++i) {
            refuse(status::Bad_UserAccessDenied);
            CHECK(heard.statuses.size() == told);
            CHECK(requester.count<ModifySubscriptionRequest>() == 0);
            pass(4s);
            static_cast<void>(requester.take<ModifySubscriptionRequest>());
        }
        refuse(status::Bad_UserAccessDenied);
        CHECK(last_status() == status::Bad_UserAccessDenied);
    }
    SECTION("but not that it made of them what makes no sense")
    {
        ModifySubscriptionResponse response;
        response.revised_publishing_interval =
            GENERATE(-1.0, std::numeric_limits<double>::quiet_NaN());
        reply(response);
        CHECK(last_status() == status::Good);
        CHECK(subscriptions.next_deadline() > requester.time);
        pass(30s); // ten intervals of 2 s and a half of that
        CHECK(requester.count<RepublishRequest>() == 0);
        pass(2s);
        CHECK(requester.count<RepublishRequest>() == 1);
    }
    CHECK(subscriptions.mode(subscription) == DeliveryMode::Publishing);
    CHECK(heard.statuses.size() == told + 1);
}

TEST_CASE_METHOD(CreationFixture, "A Subscription that may not pause says why", "[client]")
{
    start();
    client::SubscriptionSettings paused;
    paused.is_publishing_enabled = false;
    REQUIRE(subscriptions.modify(subscription, paused));
    settle();
    static_cast<void>(requester.take<ModifySubscriptionRequest>());
    ModifySubscriptionResponse modified;
    modified.revised_publishing_interval = 1'000;
    reply(modified);
    SECTION("as the server has it")
    {
        SetPublishingModeResponse response;
        response.results = {status::Bad_UserAccessDenied};
        enable(response);
        CHECK(last_status() == status::Bad_UserAccessDenied);
    }
    SECTION("or has not said")
    {
        enable({});
        CHECK(last_status() == status::Bad_UnexpectedError);
    }
    SECTION("or after some tries")
    {
        for (int i = 0; i < 4; ++i) {
            CHECK_FALSE(requester.take<SetPublishingModeRequest>().publishing_enabled);
            CHECK(last_status() == status::Good);
            refuse(status::Bad_ServiceUnsupported);
            pass(4s);
        }
        CHECK(last_status() == status::Bad_ServiceUnsupported);
    }
    CHECK(requester.count<SetPublishingModeRequest>() == 0);
}

TEST_CASE_METHOD(CreationFixture, "Items that the server keeps refusing are told so at last",
                 "[client]")
{
    start_creation(2);
    for (int i = 0; i < 3; ++i) {
        CHECK(requester.take<CreateMonitoredItemsRequest>().items_to_create.size() == 2);
        refuse(status::Bad_UserAccessDenied);
        CHECK(requester.count<CreateMonitoredItemsRequest>() == 0);
        CHECK(heard.items.empty());
        pass(4s);
    }
    static_cast<void>(requester.take<CreateMonitoredItemsRequest>());
    refuse(status::Bad_UserAccessDenied);
    REQUIRE(heard.items.size() == 2);
    CHECK(heard.items[1].first == items[1]);
    CHECK(heard.items[1].second.status == status::Bad_UserAccessDenied);
    pass(60s);
    CHECK(requester.count<CreateMonitoredItemsRequest>() == 0);
    CHECK(requester.count<CreateSubscriptionRequest>() == 0);
}

TEST_CASE_METHOD(CreationFixture, "Items that find no Subscription are made with another one",
                 "[client]")
{
    start_creation(2);
    static_cast<void>(requester.take<CreateMonitoredItemsRequest>());
    refuse(status::Bad_SubscriptionIdInvalid);
    CHECK(last_status() == status::Bad_SubscriptionIdInvalid);
    pass(1s);
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 0); // it is not there
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created(8));
    CHECK(requester.take<CreateMonitoredItemsRequest>().items_to_create.size() == 2);
}

TEST_CASE_METHOD(CreationFixture, "What changes while an item is made is changed when it is there",
                 "[client]")
{
    start_creation(3);
    const auto request = requester.take<CreateMonitoredItemsRequest>();
    REQUIRE(request.items_to_create.size() == 3);
    ItemSettings changed;
    changed.mode = MonitoringMode::Sampling;
    changed.queue_size = 5;
    REQUIRE(subscriptions.modify_items(std::vector{items[0]}, changed));
    REQUIRE(subscriptions.remove_items(std::vector{items[1]}));
    CreateMonitoredItemsResponse response;
    for (const std::uint32_t id : {101U, 102U, 103U}) {
        response.results.push_back({status::Good, id, 100, 1, {}});
    }
    reply(response);
    CHECK(heard.items.size() == 2); // not of what was removed
    CHECK(requester.take<DeleteMonitoredItemsRequest>().monitored_item_ids == Ids{102});
    reply(DeleteMonitoredItemsResponse{});
    const auto modification = requester.take<ModifyMonitoredItemsRequest>();
    REQUIRE(modification.items_to_modify.size() == 1);
    CHECK(modification.items_to_modify[0].monitored_item_id == 101);
    CHECK(modification.items_to_modify[0].requested_parameters.queue_size == 5);
    ModifyMonitoredItemsResponse modified;
    modified.results.resize(1);
    reply(modified);
    const auto mode = requester.take<SetMonitoringModeRequest>();
    CHECK(mode.monitoring_mode == MonitoringMode::Sampling);
    CHECK(mode.monitored_item_ids == Ids{101});
    CHECK(requester.count<CreateMonitoredItemsRequest>() == 0); // none is made twice
}

TEST_CASE_METHOD(CreationFixture, "Answers for a Subscription that was removed are not heeded",
                 "[client]")
{
    start_creation(1);
    static_cast<void>(requester.take<CreateMonitoredItemsRequest>());
    REQUIRE(subscriptions.remove(subscription));
    CreateMonitoredItemsResponse response;
    response.results.push_back({status::Good, 101, 100, 1, {}});
    reply(response);
    CHECK(heard.items.empty());
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids == Ids{server_id});
    CHECK(requester.count<DeleteMonitoredItemsRequest>() == 0);
}

TEST_CASE_METHOD(CreationFixture, "Items wait for the node that their path leads to", "[client]")
{
    wish({at_path("[i=85]/1:level"), at_path("[i=85]/1:none"), ItemSettings{}});
    reply(created());
    static_cast<void>(requester.take<TranslateBrowsePathsToNodeIdsRequest>());
    TranslateBrowsePathsToNodeIdsResponse response;
    BrowsePathResult found;
    found.targets.push_back({ExpandedNodeId{NodeId{1, 55}}, ~0U});
    response.results.push_back(found);
    response.results.push_back({status::Bad_NoMatch, {}});
    SECTION("and are told that it leads nowhere")
    {
        reply(response);
        REQUIRE(heard.items.size() == 1);
        CHECK(heard.items[0].first == items[1]);
        CHECK(heard.items[0].second.status == status::Bad_NoMatch);
    }
    SECTION("however long nobody says where it leads")
    {
        refuse(status::Bad_Timeout);
        // The item with a NodeId does not wait for the others.
        CHECK(requester.take<CreateMonitoredItemsRequest>().items_to_create.size() == 1);
        CreateMonitoredItemsResponse third;
        third.results.push_back({status::Good, 103, 100, 1, {}});
        reply(third);
        CHECK(heard.items.size() == 1);
        pass(1s);
        static_cast<void>(requester.take<TranslateBrowsePathsToNodeIdsRequest>());
        reply(response);
        CHECK(heard.items.back().second.status == status::Bad_NoMatch);
    }
    SECTION("unless they are removed before it is known")
    {
        REQUIRE(subscriptions.remove_items(std::vector{items[1], items[2]}));
        reply(response);
        CHECK(heard.items.empty());
    }
    const auto request = requester.take<CreateMonitoredItemsRequest>();
    REQUIRE(!request.items_to_create.empty());
    CHECK(request.items_to_create[0].item_to_monitor.node_id == NodeId{1, 55});
}

TEST_CASE_METHOD(CreationFixture, "A node that is found for another session is looked up again",
                 "[client]")
{
    wish({at_path("[i=85]/1:level")});
    reply(created());
    static_cast<void>(requester.take<TranslateBrowsePathsToNodeIdsRequest>());
    subscriptions.session_lost();
    subscriptions.session_started(Start::Resumed);
    settle();
    TranslateBrowsePathsToNodeIdsResponse response;
    BrowsePathResult found;
    found.targets.push_back({ExpandedNodeId{NodeId{1, 55}}, ~0U});
    response.results.push_back(found);
    reply(response); // the late answer to the first
    CHECK(requester.count<CreateMonitoredItemsRequest>() == 0);
    static_cast<void>(requester.take<TranslateBrowsePathsToNodeIdsRequest>());
    reply(response);
    CHECK(requester.take<CreateMonitoredItemsRequest>().items_to_create.size() == 1);
}

} // namespace subscription_creation_test
