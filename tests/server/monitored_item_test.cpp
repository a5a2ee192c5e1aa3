#include <catch2/catch.hpp>

#include "item_fixture.hpp"

namespace monitored_item_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Counts what is asked of it.
class CountingSource final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override
    {
        sizes.push_back(batch.size());
        for (auto& slot : batch.results()) {
            slot = DataValue{Variant{static_cast<std::int32_t>(sizes.size())}};
        }
        batch.complete();
    }
    std::vector<std::size_t> sizes;
};

/// What has to outlive the server.
struct CountingParts {
    CountingSource source;
};
struct CountingFixture : CountingParts, ItemFixture {};

} // namespace

TEST_CASE_METHOD(ItemFixture, "the first value is reported, then each change once",
                 "[unit:Monitor Basic][unit:Monitor Value Change]"
                 "[unit:Monitor Value Change V2]")
{
    const auto made = monitor(client, id, item_request(level, 77));
    CHECK(made.revised_sampling_interval == 50);
    CHECK(made.revised_queue_size == 1);
    const auto first = next_data(client, cycle);
    REQUIRE(first.size() == 1);
    CHECK(first[0].client_handle == 77);
    CHECK(first[0].value == DataValue{Variant{1}});
    CHECK(next_data(client, cycle).empty());
    CHECK(reported({2}) == std::vector<DataValue>{Variant{2}});
    CHECK(reported({3, 4}).back() == DataValue{Variant{4}});
    CHECK(reported({5, 4}).size() == 1); // it was sampled in between
}

TEST_CASE_METHOD(CountingFixture, "items with equal intervals are one batch, in all Subscriptions")
{
    model::NewVariable variable;
    variable.source = server.add_source(source);
    variable.data_type = NodeId{0, id::Int32};
    const NodeId a = add_variable("a", variable);
    const NodeId b = add_variable("b", variable);
    const auto second = subscribe(client);
    auto slow = item_request(b);
    slow.requested_parameters.sampling_interval = 200;
    CHECK(create_items(client, id, {item_request(a), item_request(b), slow}));
    CHECK(source.sizes == std::vector<std::size_t>{2, 1}); // initial values
    CHECK(monitor(client, second, item_request(a)).status_code == status::Good);
    CHECK(source.sizes == std::vector<std::size_t>{2, 1, 1});
    source.sizes.clear();
    advance(50ms);
    CHECK(source.sizes == std::vector<std::size_t>{3});
    advance(50ms);
    advance(50ms);
    source.sizes.clear();
    advance(50ms);
    CHECK(source.sizes.size() == 2);
    CHECK(remove(client, id) == status::Good);
    source.sizes.clear();
    advance(50ms);
    CHECK(source.sizes == std::vector<std::size_t>{1});
    CHECK(remove(client, second) == status::Good);
    source.sizes.clear();
    advance(500ms);
    advance(500ms);
    CHECK(source.sizes.empty());
    // Nothing is left that wants the time.
    CHECK(server.next_deadline() > now + 10s);
}

TEST_CASE_METHOD(ItemFixture, "a full queue discards the oldest, or replaces the newest",
                 "[unit:Monitor MinQueueSize_02][unit:Monitor Queueing]")
{
    const bool discards_oldest = GENERATE(true, false);
    monitor_level([&](auto& item) {
        item.requested_parameters.queue_size = 3;
        item.requested_parameters.discard_oldest = discards_oldest;
        item.requested_parameters.sampling_interval = 10;
    });
    CHECK(set_publishing(client, id, false) == status::Good);
    for (const int value : {2, 3, 4, 5, 6}) {
        set(0, value);
        advance(10ms);
    }
    CHECK(set_publishing(client, id, true) == status::Good);
    const auto data = next_data(client, cycle);
    REQUIRE(data.size() == 3);
    const StatusCode flagged{overflow};
    if (discards_oldest) {
        CHECK(data[0].value == DataValue{Variant{4}, flagged});
        CHECK(data[1].value == DataValue{Variant{5}});
        CHECK(data[2].value == DataValue{Variant{6}});
    } else {
        CHECK(data[0].value == DataValue{Variant{2}});
        CHECK(data[1].value == DataValue{Variant{3}});
        CHECK(data[2].value == DataValue{Variant{6}, flagged});
    }
}

TEST_CASE_METHOD(ItemFixture, "a queue of one has the newest value and no overflow bit",
                 "[unit:Monitor QueueSize_1]")
{
    const bool discards_oldest = GENERATE(true, false);
    monitor_level([&](auto& item) {
        item.requested_parameters.queue_size = 0;
        item.requested_parameters.discard_oldest = discards_oldest;
    });
    CHECK(set_publishing(client, id, false) == status::Good);
    CHECK(reported({2, 3, 4}).empty());
    CHECK(set_publishing(client, id, true) == status::Good);
    const auto all = next_data(client, cycle);
    REQUIRE(all.size() == 1);
    CHECK(all[0].value == DataValue{Variant{4}});
}

TEST_CASE_METHOD(ItemFixture, "a changed queue size keeps what it can")
{
    const auto made = monitor_level([](auto& item) {
        item.requested_parameters.queue_size = 10;
        item.requested_parameters.sampling_interval = 10;
    });
    CHECK(set_publishing(client, id, false) == status::Good);
    for (const int value : {2, 3, 4, 5, 6}) {
        set(0, value);
        advance(10ms);
    }
    ModifyMonitoredItemsRequest request;
    request.subscription_id = id;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.items_to_modify.resize(2); // the same item twice
    for (auto& change : request.items_to_modify) {
        change.monitored_item_id = made.monitored_item_id;
        change.requested_parameters.client_handle = 9;
        change.requested_parameters.sampling_interval = 10;
        change.requested_parameters.discard_oldest = true;
    }
    request.items_to_modify[0].requested_parameters.queue_size = 2;
    request.items_to_modify[1].requested_parameters.queue_size = 4;
    const auto response = client.call<ModifyMonitoredItemsResponse>(request);
    REQUIRE(response);
    CHECK(response->results[0].revised_queue_size == 2);
    CHECK(response->results[1].revised_queue_size == 4);
    CHECK(set_publishing(client, id, true) == status::Good);
    const auto data = next_data(client, cycle);
    REQUIRE(data.size() == 2);
    CHECK(data[0].client_handle == 9);
    CHECK(data[0].value == DataValue{Variant{5}, StatusCode{overflow}});
    CHECK(data[1].value == DataValue{Variant{6}});
}

TEST_CASE_METHOD(ItemFixture, "any attribute can be monitored")
{
    auto item = item_request(level);
    item.item_to_monitor.attribute_id = 4; // DisplayName
    CHECK(monitor(client, id, item).status_code == status::Good);
    CHECK(next_data(client, cycle).size() == 1);
    auto& space = server.address_space();
    space.set_display_name(space.find(level), LocalizedText{String{"height"}});
    const auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.value == Variant{LocalizedText{String{"height"}}});
}

TEST_CASE_METHOD(ItemFixture, "nodes that go and rights that are lost are reported")
{
    monitor_level([](auto&) {});
    auto& space = server.address_space();
    space.set_access_level(space.find(level), model::Access::Read, model::Access::None);
    auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.status == status::Bad_UserAccessDenied);
    space.set_access_level(space.find(level), model::Access::Write);
    data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.status == status::Bad_NotReadable);
    REQUIRE(space.remove(space.find(level)));
    data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.status == status::Bad_NodeIdUnknown);
    add_variable("level", 5);
    data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{Variant{5}});
}

TEST_CASE_METHOD(ItemFixture, "timestamps are what the client wants")
{
    const auto timestamps = GENERATE(TimestampsToReturn::Source, TimestampsToReturn::Server,
                                     TimestampsToReturn::Both, TimestampsToReturn::Neither);
    set(0, 1);
    CHECK(monitor(client, id, item_request(level), timestamps).status_code == status::Good);
    const auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    const bool has_source =
        timestamps == TimestampsToReturn::Source || timestamps == TimestampsToReturn::Both;
    const bool has_server =
        timestamps == TimestampsToReturn::Server || timestamps == TimestampsToReturn::Both;
    CHECK(data[0].value.source_timestamp.is_null() != has_source);
    CHECK(data[0].value.server_timestamp.is_null() != has_server);
}

TEST_CASE_METHOD(ItemFixture, "modes: disabled has no queue, sampling does not report",
                 "[unit:Monitor Basic]")
{
    const auto made = monitor_level([](auto& item) { item.requested_parameters.queue_size = 5; });
    const std::uint32_t item = made.monitored_item_id;
    CHECK(set_mode(client, id, item, MonitoringMode::Sampling) == status::Good);
    const auto request = publish(client);
    set(0, 2);
    advance(cycle);
    set(0, 3);
    advance(cycle);
    CHECK(status_of(client, request) == status::Bad_WouldBlock);
    CHECK(set_mode(client, id, item, MonitoringMode::Reporting) == status::Good);
    advance(cycle);
    const auto response = take(client, request);
    REQUIRE(response);
    CHECK(data(response->notification_message).size() == 2);

    CHECK(set_mode(client, id, item, MonitoringMode::Sampling) == status::Good);
    set(0, 4);
    advance(cycle);
    CHECK(set_mode(client, id, item, MonitoringMode::Disabled) == status::Good);
    set(0, 5);
    advance(cycle);
    // Enabled again it has a first value.
    CHECK(set_mode(client, id, item, MonitoringMode::Reporting) == status::Good);
    const auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{Variant{5}});
}

TEST_CASE("the links of an item are limited")
{
    server::SubscriptionLimits limits;
    limits.max_triggering_links = 2;
    SubscriptionFixture fixture{limits};
    auto client = fixture.log_in();
    const std::uint32_t id = fixture.subscribe(client);
    const NodeId level = fixture.add_variable("level", 1);
    std::vector<std::uint32_t> items;
    for (std::uint32_t i = 0; i < 4; ++i) {
        items.push_back(
            fixture.monitor(client, id, fixture.item_request(level, i)).monitored_item_id);
    }
    const auto link = [&](std::uint32_t trigger, std::uint32_t triggered) {
        SetTriggeringRequest request;
        request.subscription_id = id;
        request.triggering_item_id = trigger;
        request.links_to_add = {triggered};
        return client.call<SetTriggeringResponse>(request)->add_results[0];
    };
    CHECK(link(items[0], items[1]) == status::Good);
    CHECK(link(items[0], items[2]) == status::Good);
    CHECK(link(items[0], items[3]) == status::Bad_TooManyOperations);
    CHECK(link(items[0], items[1]) == status::Good); // it is there
    CHECK(link(items[3], items[2]) == status::Good);
    CHECK(link(items[1], items[2]) == status::Bad_TooManyOperations); // it has two triggers
}

TEST_CASE_METHOD(ItemFixture, "an item that is triggered reports what it has queued until then",
                 "[unit:Monitor Triggering]")
{
    const NodeId button = add_variable("button", false, id::Boolean);
    const auto trigger = monitor(client, id, item_request(button, 1)).monitored_item_id;
    auto request = item_request(level, 2);
    request.requested_parameters.queue_size = 10;
    request.monitoring_mode = MonitoringMode::Sampling;
    const auto triggered = monitor(client, id, request).monitored_item_id;
    CHECK(next_data(client, cycle).size() == 1); // the button's first value

    SetTriggeringRequest links;
    links.subscription_id = id;
    links.triggering_item_id = trigger;
    links.links_to_add = {triggered, triggered};
    REQUIRE(client.call<SetTriggeringResponse>(links));
    CHECK(reported({2, 3}).empty());
    set(1, true);
    const auto both = next_data(client, cycle);
    REQUIRE(both.size() == 4); // the button, and what the level had: 1, 2, 3
    CHECK(reported({4}).empty());
    // A trigger that only samples triggers too, and is not reported itself.
    CHECK(set_mode(client, id, trigger, MonitoringMode::Sampling) == status::Good);
    set(1, false);
    const auto rest = next_data(client, cycle);
    REQUIRE(rest.size() == 1);
    CHECK(rest[0].client_handle == 2);
    CHECK(rest[0].value == DataValue{Variant{4}});
    links.links_to_add = {};
    links.links_to_remove = {triggered};
    const auto removed = client.call<SetTriggeringResponse>(links);
    REQUIRE(removed);
    CHECK(removed->remove_results == Array<StatusCode>{status::Good});
    const auto again = client.call<SetTriggeringResponse>(links);
    REQUIRE(again);
    CHECK(again->remove_results == Array<StatusCode>{status::Bad_MonitoredItemIdInvalid});
    set(1, true);
    CHECK(reported({5}).empty());
}

} // namespace monitored_item_test
