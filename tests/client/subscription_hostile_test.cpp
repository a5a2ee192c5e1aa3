#include <catch2/catch.hpp>

#include <busbar/types/filter.hpp>

#include "puppet_fixture.hpp"

namespace subscription_hostile_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::DeliveryMode;
using Start = Subscriptions::SessionStart;
using Values = std::vector<std::int32_t>;

TEST_CASE_METHOD(PuppetFixture, "Revised values that make no sense do no harm", "[client]")
{
    subscription = subscriptions.create({}, heard.handlers()).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    auto response = created(server_id, GENERATE(std::numeric_limits<double>::quiet_NaN(), -1.0, 0.0,
                                                std::numeric_limits<double>::infinity(), 1e300));
    response.revised_max_keep_alive_count = GENERATE(0U, ~0U);
    response.revised_lifetime_count = 0;
    reply(response);
    CHECK(requester.count<PublishRequest>() == 2);
    CHECK(subscriptions.next_deadline() > requester.time);
    CHECK(subscriptions.next_deadline() < requester.time + 48h);
    pass(1s);
    CHECK(requester.count<RepublishRequest>() == 0);
}

TEST_CASE_METHOD(PuppetFixture, "Notifications of what nobody wants are dropped", "[client]")
{
    start(2);
    DataChangeNotification data;
    data.monitored_items.push_back({items[0] + 1'000, DataValue{1}}); // never given
    data.monitored_items.push_back({0, DataValue{2}});
    data.monitored_items.push_back({~0U, DataValue{3}});
    data.monitored_items.push_back({items[0], DataValue{4}});
    data.monitored_items.push_back({items[1], DataValue{5}});
    REQUIRE(subscriptions.remove_items(std::array{items[0]}));
    NotificationMessage content{1, time_of(1), {}};
    content.notification_data.push_back(ExtensionObject::from(data));
    publish(std::move(content));
    CHECK(heard.take_values() == Values{5});
    // A new item in the place of the old one is another.
    client::ItemSettings wish;
    wish.node = NodeId{1, 1};
    const auto added = subscriptions.add_items(subscription, {wish}).value();
    CHECK(added[0] != items[0]);
    publish(message(2));
    CHECK(heard.data.empty());
}

TEST_CASE_METHOD(PuppetFixture, "Parts of messages that are no notifications are a Gap", "[client]")
{
    start();
    publish(message(1));
    NotificationMessage content{2, time_of(2), {}};
    content.notification_data.push_back(ExtensionObject::from(DataChangeFilter{}));
    content.notification_data.push_back(ExtensionObject{});
    publish(std::move(content));
    publish(message(3));
    CHECK(heard.take_values() == Values{1, 3});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_DecodingError);
    CHECK(heard.gaps[0].from == time_of(1));
}

TEST_CASE_METHOD(PuppetFixture, "A server that counts from elsewhere is heard again", "[client]")
{
    start();
    for (std::uint32_t number = 1; number <= 5; ++number) {
        publish(message(number));
    }
    CHECK(heard.take_values() == Values{1, 2, 3, 4, 5});
    publish(message(1));
    publish(message(2));
    CHECK(heard.data.empty()); // they may still be repeated ones
    publish(message(3));
    CHECK(heard.take_values() == Values{3});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_SequenceNumberUnknown);
    publish(message(4));
    CHECK(heard.take_values() == Values{4});
    CHECK(heard.gaps.size() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "Single messages that are sent again are no new ones", "[client]")
{
    start();
    for (std::uint32_t number = 1; number <= 9; ++number) {
        publish(message(number));
        publish(message(number));
    }
    CHECK(heard.take_values() == Values{1, 2, 3, 4, 5, 6, 7, 8, 9});
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "A server that answers Read alone does not keep a Subscription",
                 "[client]")
{
    start();
    publish(message(1));
    for (int i = 0; i < 600 && requester.count<DeleteSubscriptionsRequest>() == 0; ++i) {
        pass(1s);
        if (requester.count<RepublishRequest>() != 0) {
            static_cast<void>(requester.take<RepublishRequest>());
            refuse(status::Bad_Timeout);
        }
        if (requester.count<ReadRequest>() != 0) {
            static_cast<void>(requester.take<ReadRequest>());
            reply(ReadResponse{});
        }
    }
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids ==
          Array<std::uint32_t>{server_id});
    CHECK(requester.count<CreateSubscriptionRequest>() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "A keep-alive interval of years is not waited for", "[client]")
{
    subscription = subscriptions.create({}, heard.handlers()).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    auto response = created();
    response.revised_max_keep_alive_count = ~0U;
    reply(response);
    pass(1min);
    CHECK(requester.count<RepublishRequest>() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "A Subscription that nobody knows is deleted", "[client]")
{
    start();
    publish(message(1), 99);
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids ==
          Array<std::uint32_t>{99});
    publish(message(2), 99);
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 0); // one at a time
    CHECK(heard.data.empty());
}

TEST_CASE_METHOD(PuppetFixture, "Results of acknowledgements that nobody made do not count",
                 "[client]")
{
    start();
    CHECK(requester.take<PublishRequest>().subscription_acknowledgements.empty());
    PublishResponse response;
    response.subscription_id = server_id;
    response.notification_message = message(1);
    response.results = {status::Bad_SubscriptionIdInvalid, status::Bad_SubscriptionIdInvalid};
    reply(response);
    CHECK(heard.take_values() == Values{1});
    // Nor do those that are missing.
    publish(message(2));
    CHECK_FALSE(requester.take<PublishRequest>().subscription_acknowledgements.empty());
    response.notification_message = message(3);
    response.results = {};
    reply(response);
    CHECK(heard.take_values() == Values{2, 3});
    CHECK(requester.count<CreateSubscriptionRequest>() == 0);
}

TEST_CASE_METHOD(PuppetFixture, "Fewer Publish requests go out when there are too many",
                 "[client][unit:Subscription Client Publish Multiple]")
{
    for (int i = 0; i < 5; ++i) {
        static_cast<void>(subscriptions.create({}, heard.handlers()));
    }
    settle();
    for (std::uint32_t i = 1; i <= 5; ++i) {
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
        reply(created(i));
    }
    CHECK(requester.count<PublishRequest>() == 6);
    static_cast<void>(requester.take<PublishRequest>());
    refuse(status::Bad_TooManyPublishRequests);
    CHECK(requester.count<PublishRequest>() == 5);
    for (int i = 0; i < 10; ++i) {
        publish({1, time_of(1), {}}, 1);
    }
    CHECK(requester.count<PublishRequest>() == 5);
    while (requester.count<PublishRequest>() > 0) {
        static_cast<void>(requester.take<PublishRequest>());
        refuse(status::Bad_TooManyPublishRequests);
    }
    pass(1s);
    CHECK(requester.count<PublishRequest>() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "A server that takes its Subscription away is asked once a second",
                 "[client]")
{
    start();
    int creations = 0;
    for (int i = 0; i < 100; ++i) {
        pass(100ms);
        if (requester.count<CreateSubscriptionRequest>() > 0) {
            ++creations;
            static_cast<void>(requester.take<CreateSubscriptionRequest>());
            reply(created());
        }
        if (requester.count<PublishRequest>() > 0) {
            publish_status(1, status::Bad_Timeout);
        }
    }
    CHECK(creations >= 5);
    CHECK(creations <= 11);
}

TEST_CASE_METHOD(PuppetFixture, "Lists and answers without end are not followed", "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    static_cast<void>(requester.take<TransferSubscriptionsRequest>());
    TransferSubscriptionsResponse response;
    response.results.resize(1);
    auto& numbers = response.results[0].available_sequence_numbers;
    numbers.resize(60'000);
    for (std::uint32_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = i * 40'001;
    }
    reply(response);
    std::uint32_t number = 2;
    for (; requester.count<RepublishRequest>() > 0 && number < 10'000; ++number) {
        republish(number);
    }
    CHECK(number > 1'000);
    CHECK(number <= 1'003);
    CHECK(heard.gaps.empty());
    // Messages that wait for one that does not come are not taken without end.
    for (std::uint32_t i = number + 1; requester.count<PublishRequest>() > 0 && i < 10'000; ++i) {
        publish(message(i));
        number = i;
    }
    CHECK(number < 1'500);
    static_cast<void>(requester.take<RepublishRequest>());
    refuse(status::Bad_MessageNotAvailable);
    CHECK(requester.count<PublishRequest>() == 2);
    CHECK(heard.gaps.size() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "Items whose fate is unknown are made with a new Subscription",
                 "[client]")
{
    subscription = subscriptions.create({}, heard.handlers()).value();
    REQUIRE(subscriptions.add_items(subscription, std::vector<client::ItemSettings>(3)));
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    const auto request = requester.take<CreateMonitoredItemsRequest>();
    CHECK(request.items_to_create.size() == 3);
    SECTION("nobody answered")
    {
        refuse(status::Bad_Timeout);
    }
    SECTION("the answer does not fit")
    {
        CreateMonitoredItemsResponse response;
        response.results.resize(2);
        reply(response);
    }
    SECTION("the connection broke")
    {
        subscriptions.session_lost();
        subscriptions.session_started(Start::Resumed);
        settle();
    }
    pass(1s);
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids[0] == server_id);
    reply(DeleteSubscriptionsResponse{});
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created(8));
    CHECK(requester.take<CreateMonitoredItemsRequest>().items_to_create.size() == 3);
    CHECK(heard.gaps.empty()); // nothing was ever delivered
}

TEST_CASE_METHOD(PuppetFixture, "Calls that are too large are made smaller", "[client]")
{
    subscription = subscriptions.create({}, heard.handlers()).value();
    REQUIRE(subscriptions.add_items(subscription, std::vector<client::ItemSettings>(100)));
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    for (const std::size_t size : {100U, 50U, 25U}) {
        CHECK(requester.take<CreateMonitoredItemsRequest>().items_to_create.size() == size);
        refuse(status::Bad_ResponseTooLarge);
    }
    std::size_t made = 0;
    while (requester.count<CreateMonitoredItemsRequest>() > 0) {
        const auto request = requester.take<CreateMonitoredItemsRequest>();
        CreateMonitoredItemsResponse response;
        response.results.resize(request.items_to_create.size());
        made += request.items_to_create.size();
        reply(response);
    }
    CHECK(made == 100);
    CHECK(heard.items.size() == 100);
}

TEST_CASE_METHOD(PuppetFixture, "Triggering is made and changed by its difference",
                 "[client][unit:Monitor Client Trigger]")
{
    start(4);
    REQUIRE(subscriptions.set_triggering(items[0], {items[1], items[2]}));
    settle();
    auto request = requester.take<SetTriggeringRequest>();
    CHECK(request.triggering_item_id == 101);
    CHECK(request.links_to_add == Array<std::uint32_t>{102, 103});
    reply(SetTriggeringResponse{});
    REQUIRE(subscriptions.set_triggering(items[0], {items[2], items[3]}));
    settle();
    request = requester.take<SetTriggeringRequest>();
    CHECK(request.links_to_add == Array<std::uint32_t>{104});
    CHECK(request.links_to_remove == Array<std::uint32_t>{102});
    subscriptions.session_lost(); // before the answer
    subscriptions.session_started(Start::Resumed);
    settle();
    request = requester.take<SetTriggeringRequest>();
    CHECK(request.links_to_add == Array<std::uint32_t>{103, 104});
    CHECK(request.links_to_remove == Array<std::uint32_t>{102}); // nobody knows whether it is there
    reply(SetTriggeringResponse{});
    REQUIRE(subscriptions.set_triggering(items[0], {items[3]}));
    settle();
    CHECK(requester.take<SetTriggeringRequest>().links_to_remove == Array<std::uint32_t>{103});
}

TEST_CASE_METHOD(PuppetFixture, "An item that is changed before it is made is made once",
                 "[client]")
{
    subscription = subscriptions.create({}, heard.handlers()).value();
    items = subscriptions.add_items(subscription, std::vector<client::ItemSettings>(2)).value();
    client::ItemSettings slower;
    slower.sampling_interval = std::chrono::seconds{5};
    REQUIRE(subscriptions.modify_items(std::vector{items[0]}, slower));
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    const auto request = requester.take<CreateMonitoredItemsRequest>();
    REQUIRE(request.items_to_create.size() == 2);
    CHECK(request.items_to_create[0].requested_parameters.sampling_interval == 5'000);
}

TEST_CASE_METHOD(PuppetFixture, "Handlers may remove what calls them", "[client]")
{
    auto handlers = heard.handlers();
    handlers.on_data = [this](std::span<const client::DataChange> changes) {
        heard.data.insert(heard.data.end(), changes.begin(), changes.end());
        static_cast<void>(subscriptions.remove(subscription));
    };
    subscription = subscriptions.create({}, handlers).value();
    items = subscriptions.add_items(subscription, std::vector<client::ItemSettings>(1)).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    make_items();
    publish(message(1));
    CHECK(heard.data.size() == 1);
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids[0] == server_id);
}

} // namespace subscription_hostile_test
