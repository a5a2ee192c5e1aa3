#include <catch2/catch.hpp>

#include <limits>

#include <busbar/types/filter.hpp>

#include "puppet_fixture.hpp"

namespace subscription_polling_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::DeliveryMode;
using Start = Subscriptions::SessionStart;
using Values = std::vector<std::int32_t>;

namespace {

/// A server without the Subscription Service Set.
struct PollingFixture : PuppetFixture {
    void start_polling(std::vector<client::ItemSettings> wishes)
    {
        subscription = subscriptions.create({}, heard.handlers()).value();
        items = subscriptions.add_items(subscription, std::move(wishes)).value();
        settle();
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
        refuse(status::Bad_ServiceUnsupported);
    }
    [[nodiscard]] static client::ItemSettings wish(std::uint32_t node, Duration interval)
    {
        client::ItemSettings settings;
        settings.node = NodeId{1, node};
        settings.sampling_interval = interval;
        return settings;
    }
    ReadRequest read(std::vector<DataValue> values, std::uint32_t time = 0)
    {
        const auto request = requester.take<ReadRequest>();
        ReadResponse response;
        response.response_header.timestamp = time_of(time);
        response.results = Array<DataValue>{values};
        reply(response);
        return request;
    }
};

} // namespace

TEST_CASE_METHOD(PollingFixture, "Without Subscriptions values are read",
                 "[client][unit:Subscription Client Fallback]")
{
    start_polling({wish(1, 100ms), wish(2, 100ms), wish(3, 1s)});
    CHECK(subscriptions.mode(subscription) == DeliveryMode::Polling);
    CHECK(heard.statuses.back() == std::pair{StatusCode{}, DeliveryMode::Polling});
    CHECK(requester.count<PublishRequest>() == 0);
    CHECK(requester.count<ReadRequest>() == 2);
    const auto request = read({DataValue{1}, DataValue{2}});
    CHECK(request.nodes_to_read.size() == 2);
    CHECK(request.nodes_to_read[0].node_id == NodeId{1, 1});
    read({DataValue{3}});
    CHECK(heard.take_values() == Values{1, 2, 3});
    REQUIRE(heard.items.size() == 3);
    CHECK(heard.items[0].second.revised_sampling_interval == 100);
    pass(100ms);
    read({DataValue{1}, DataValue{4}});
    CHECK(heard.take_values() == Values{4});
    pass(100ms);
    read({DataValue{StatusCode{status::Bad_NodeIdUnknown}}, DataValue{4}});
    REQUIRE(heard.data.size() == 1);
    CHECK(heard.data[0].value.status == status::Bad_NodeIdUnknown);
    CHECK(requester.count<ReadRequest>() == 0); // until they are due again
}

TEST_CASE_METHOD(PollingFixture, "Filters and modes of polled items are heeded", "[client]")
{
    auto filtered = wish(1, 100ms);
    DataChangeFilter filter;
    filter.trigger = DataChangeTrigger::StatusValue;
    filter.deadband_type = static_cast<std::uint32_t>(DeadbandType::Absolute);
    filter.deadband_value = 5;
    filtered.filter = ExtensionObject::from(filter);
    auto disabled = wish(2, 100ms);
    disabled.mode = MonitoringMode::Disabled;
    auto event = wish(3, 100ms);
    event.filter = ExtensionObject::from(EventFilter{});
    start_polling({filtered, disabled, event});
    CHECK(read({DataValue{10}}).nodes_to_read.size() == 1);
    for (const std::int32_t value : {15, 5, 16, 12}) {
        pass(100ms);
        read({DataValue{value}});
    }
    CHECK(heard.take_values() == Values{10, 16});
    CHECK(heard.items.back().first == items[2]);
    CHECK(heard.items.back().second.status == status::Bad_ServiceUnsupported);
    disabled.mode = MonitoringMode::Reporting;
    REQUIRE(subscriptions.modify_items(std::array{items[1]}, disabled));
    REQUIRE(subscriptions.remove_items(std::array{items[0]}));
    pass(100ms);
    const auto request = read({DataValue{7}});
    REQUIRE(request.nodes_to_read.size() == 1);
    CHECK(request.nodes_to_read[0].node_id == NodeId{1, 2});
    CHECK(heard.take_values() == Values{7});
}

TEST_CASE_METHOD(PollingFixture, "Polled items are read in calls of the server's size", "[client]")
{
    requester.info.operation_limits.max_nodes_per_read = 30;
    start_polling(std::vector<client::ItemSettings>(100, wish(1, 100ms)));
    for (const std::size_t size : {30U, 30U, 30U, 10U}) {
        CHECK(requester.count<ReadRequest>() == 1);
        CHECK(read(std::vector<DataValue>(size, DataValue{1})).nodes_to_read.size() == size);
    }
    CHECK(heard.data.size() == 100);
    CHECK(requester.count<ReadRequest>() == 0);
}

TEST_CASE_METHOD(PollingFixture, "A Read that fails is made again at the next interval", "[client]")
{
    start_polling({wish(1, 100ms), wish(2, 100ms)});
    static_cast<void>(requester.take<ReadRequest>());
    refuse(status::Bad_ResponseTooLarge);
    CHECK(requester.count<ReadRequest>() == 0);
    pass(100ms);
    read({DataValue{1}});
    read({DataValue{2}});
    CHECK(heard.take_values() == Values{1, 2});
}

TEST_CASE_METHOD(PollingFixture, "Polling ends when a session has Subscriptions", "[client]")
{
    start_polling({wish(1, 100ms)});
    read({DataValue{1}}, 1);
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    make_items();
    static_cast<void>(requester.take<SetPublishingModeRequest>());
    SetPublishingModeResponse enabled;
    enabled.results = {status::Good};
    reply(enabled);
    CHECK(subscriptions.mode(subscription) == DeliveryMode::Publishing);
    auto first = message(1);
    first.publish_time = time_of(9);
    publish(first);
    CHECK(heard.take_values() == Values{1, 1});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_NoSubscription);
    CHECK(heard.gaps[0].from == time_of(1));
    CHECK(heard.gaps[0].to == time_of(9));
    pass(10s);
    CHECK(requester.count<ReadRequest>() == 0);
}

TEST_CASE_METHOD(PollingFixture, "A Read with too few values is made again in smaller parts",
                 "[client]")
{
    start_polling({wish(1, 100ms), wish(2, 100ms)});
    CHECK(read({DataValue{1}}).nodes_to_read.size() == 2);
    CHECK(heard.data.empty()); // whose value is it?
    pass(100ms);
    read({DataValue{1}});
    read({DataValue{2}});
    CHECK(heard.take_values() == Values{1, 2});
}

TEST_CASE_METHOD(PollingFixture, "Intervals that make no sense are polled at others", "[client]")
{
    std::vector<client::ItemSettings> wishes(4, wish(1, 100ms));
    using Milliseconds = std::chrono::duration<double, std::milli>;
    wishes[0].sampling_interval = Milliseconds{std::numeric_limits<double>::quiet_NaN()};
    wishes[1].sampling_interval = Milliseconds{-1};
    wishes[2].sampling_interval = Milliseconds{0};
    wishes[3].sampling_interval = Milliseconds{1e300};
    start_polling(wishes);
    REQUIRE(heard.items.size() == 4);
    CHECK(heard.items[0].second.revised_sampling_interval == 500); // of the Subscription
    CHECK(heard.items[1].second.revised_sampling_interval == 500);
    CHECK(heard.items[2].second.revised_sampling_interval == 50);
    CHECK(heard.items[3].second.revised_sampling_interval == 86'400'000);
}

TEST_CASE_METHOD(PollingFixture, "What is polled and removed is not read any more", "[client]")
{
    auto handlers = heard.handlers();
    SECTION("by who is told of it")
    {
        handlers.on_data = [this](std::span<const client::DataChange>) {
            REQUIRE(subscriptions.remove(subscription));
        };
        requester.info.operation_limits.max_nodes_per_read = 1;
    }
    SECTION("while it is read")
    {
        handlers.on_data = nullptr;
    }
    subscription = subscriptions.create({}, handlers).value();
    items = subscriptions.add_items(subscription, {wish(1, 100ms), wish(2, 100ms)}).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    refuse(status::Bad_NotImplemented);
    const auto request = requester.take<ReadRequest>();
    if (!handlers.on_data) {
        REQUIRE(subscriptions.remove_items(items));
    }
    ReadResponse response;
    response.results = Array<DataValue>(request.nodes_to_read.size());
    reply(response);
    pass(10s);
    CHECK(requester.open_count() == 0); // no DeleteMonitoredItems either
    CHECK(subscriptions.next_deadline() == no_deadline);
}

TEST_CASE_METHOD(PollingFixture, "A polled item is told of what its filter is for", "[client]")
{
    const auto filtered = [](std::uint32_t node, DataChangeTrigger trigger, double deadband) {
        DataChangeFilter filter;
        filter.trigger = trigger;
        filter.deadband_type = static_cast<std::uint32_t>(DeadbandType::Absolute);
        filter.deadband_value = deadband;
        auto settings = wish(node, 100ms);
        settings.filter = ExtensionObject::from(filter);
        return settings;
    };
    start_polling({filtered(1, DataChangeTrigger::Status, 0),
                   filtered(2, DataChangeTrigger::StatusValueTimestamp, 0),
                   filtered(3, DataChangeTrigger::StatusValue, -1)});
    const auto told = [&](const DataValue& value) {
        pass(100ms);
        read({value, value, value});
        std::vector<ItemHandle> handles;
        for (const client::DataChange& change : std::exchange(heard.data, {})) {
            handles.push_back(change.item);
        }
        return handles;
    };
    read(std::vector<DataValue>(3, DataValue{1}));
    heard.data.clear();
    using Handles = std::vector<ItemHandle>;
    CHECK(told(DataValue{2}) == Handles{items[1], items[2]});
    CHECK(told(DataValue{2}).empty());
    CHECK(told(DataValue{Variant{2}, {}, time_of(5)}) == Handles{items[1]});
    CHECK(told(DataValue{Variant{2}, status::Uncertain_LastUsableValue, time_of(5)}) == items);
}

} // namespace subscription_polling_test
