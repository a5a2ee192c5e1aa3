#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include "subscription_fixture.hpp"
#include "support/slow_server.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 100ms;
constexpr std::uint32_t overflow = 0x0480;

struct ItemFixture : SubscriptionFixture {
    explicit ItemFixture(const server::SubscriptionLimits& limits = small_limits())
        : SubscriptionFixture{limits}
    {
    }

    /// An item of `level` as `change` has it; the initial value is taken.
    template <typename Change>
    MonitoredItemCreateResult monitor_level(Change change)
    {
        auto item = item_request(level);
        change(item);
        const auto made = monitor(client, id, item);
        CHECK(made.status_code == status::Good);
        CHECK(next_data(client, cycle).size() == 1);
        return made;
    }
    /// Gives the variable each value and has it sampled; what of it was published then.
    std::vector<DataValue> reported(std::initializer_list<Variant> values)
    {
        for (const Variant& value : values) {
            set(0, value);
            advance(50ms);
        }
        std::vector<DataValue> all;
        for (const auto& notification : next_data(client, cycle)) {
            all.push_back(notification.value);
        }
        return all;
    }

    NodeId level{add_variable("level", 1)};
    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
};

ExtensionObject change_filter(DataChangeTrigger trigger, DeadbandType type = DeadbandType::None,
                              double value = 0)
{
    DataChangeFilter filter;
    filter.trigger = trigger;
    filter.deadband_type = static_cast<std::uint32_t>(type);
    filter.deadband_value = value;
    return ExtensionObject::from(filter);
}

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

TEST_CASE_METHOD(ItemFixture, "the first value is reported, then each change once")
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

TEST_CASE_METHOD(ItemFixture, "a full queue discards the oldest, or replaces the newest")
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

TEST_CASE_METHOD(ItemFixture, "a queue of one has the newest value and no overflow bit")
{
    monitor_level([](auto& item) { item.requested_parameters.queue_size = 0; });
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

TEST_CASE_METHOD(ItemFixture, "triggers of a DataChangeFilter")
{
    SECTION("Status")
    {
        monitor_level([](auto& item) {
            item.requested_parameters.filter = change_filter(DataChangeTrigger::Status);
        });
        CHECK(reported({2}).empty());
        set(0, 3, status::Uncertain_LastUsableValue);
        const auto data = next_data(client, cycle);
        REQUIRE(data.size() == 1);
        CHECK(data[0].value == DataValue{Variant{3}, status::Uncertain_LastUsableValue});
    }
    SECTION("StatusValue")
    {
        monitor_level([](auto& item) {
            item.requested_parameters.filter = change_filter(DataChangeTrigger::StatusValue);
        });
        CHECK(reported({1}).empty()); // a new timestamp
    }
    SECTION("StatusValueTimestamp")
    {
        monitor_level([](auto& item) {
            item.requested_parameters.filter =
                change_filter(DataChangeTrigger::StatusValueTimestamp);
        });
        CHECK(reported({1}).size() == 1);
    }
}

TEST_CASE_METHOD(ItemFixture, "absolute deadbands of numbers")
{
    const NodeId flow = add_variable("flow", 1.0, id::Double);
    auto item = item_request(flow);
    item.requested_parameters.filter =
        change_filter(DataChangeTrigger::StatusValue, DeadbandType::Absolute, 2);
    CHECK(monitor(client, id, item).status_code == status::Good);
    CHECK(next_data(client, cycle).size() == 1);
    const auto is_reported = [&](double value) {
        set(1, value);
        return !next_data(client, cycle).empty();
    };
    CHECK_FALSE(is_reported(3));
    CHECK(is_reported(3.1));
    CHECK_FALSE(is_reported(1.1));
    CHECK(is_reported(std::numeric_limits<double>::quiet_NaN()));
    CHECK_FALSE(is_reported(std::numeric_limits<double>::quiet_NaN()));
    CHECK(is_reported(1.1));
    set(1, 1.1, status::Uncertain_LastUsableValue); // a change of status passes
    CHECK(next_data(client, cycle).size() == 1);
}

TEST_CASE_METHOD(ItemFixture, "deadbands of arrays and of unsigned 64-bit numbers")
{
    const NodeId row = add_variable("row", Array<std::int32_t>{1, 2, 3}, id::Int32, 1);
    const NodeId total = add_variable("total", UINT64_MAX, id::UInt64);
    for (const NodeId& node : {row, total}) {
        auto item = item_request(node);
        item.requested_parameters.filter =
            change_filter(DataChangeTrigger::StatusValue, DeadbandType::Absolute, 10);
        CHECK(monitor(client, id, item).status_code == status::Good);
    }
    CHECK(next_data(client, cycle).size() == 2);
    set(1, Array<std::int32_t>{11, -8, 13});
    set(2, UINT64_MAX - 10);
    CHECK(next_data(client, cycle).empty());
    set(1, Array<std::int32_t>{1, 2, 14});
    set(2, UINT64_MAX - 11);
    CHECK(next_data(client, cycle).size() == 2);
    set(1, Array<std::int32_t>{1, 2}); // another length
    CHECK(next_data(client, cycle).size() == 1);
}

TEST_CASE_METHOD(ItemFixture, "a deadband in percent of the EURange, and its change")
{
    auto& space = server.address_space();
    const auto node = space.find(level);
    model::NewNode property;
    property.browse_name = QualifiedName{0, "EURange"};
    property.parent = node;
    model::NewVariable range;
    range.data_type = NodeId{0, id::Range};
    range.value = ExtensionObject::from(Range{0, 200});
    const auto made = space.add_property(property, range);
    REQUIRE(made);
    monitor_level([](auto& item) {
        item.requested_parameters.filter =
            change_filter(DataChangeTrigger::StatusValue, DeadbandType::Percent, 5);
    });
    CHECK(reported({11}).empty());
    CHECK(reported({12}).size() == 1);

    REQUIRE(space.set_value(*made, ExtensionObject::from(Range{0, 20})));
    server.announce_semantics_change(level);
    const auto told = next_data(client, cycle);
    REQUIRE(told.size() == 1);
    CHECK(told[0].value == DataValue{Variant{12}, StatusCode{0x4000}});
    CHECK(reported({14}) == std::vector<DataValue>{Variant{14}});
    server.announce_structure_change(level);
    const auto structure = next_data(client, cycle);
    REQUIRE(structure.size() == 1);
    CHECK(structure[0].value.status == StatusCode{0x8000});
}

TEST_CASE_METHOD(ItemFixture, "a range of an array is an item of its own")
{
    const NodeId row = add_variable("row", Array<std::int32_t>{1, 2, 3}, id::Int32, 1);
    auto item = item_request(row);
    item.item_to_monitor.index_range = "1:2";
    CHECK(monitor(client, id, item).status_code == status::Good);
    auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{Variant{Array<std::int32_t>{2, 3}}});
    set(1, Array<std::int32_t>{9, 2, 3});
    CHECK(next_data(client, cycle).empty());
    set(1, Array<std::int32_t>{9}); // nothing is left in the range
    data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{status::Bad_IndexRangeNoData});
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
    space.set_access_level(space.find(level), 1, 0);
    auto data = next_data(client, cycle);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value.status == status::Bad_UserAccessDenied);
    space.set_access_level(space.find(level), 2, 2);
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

TEST_CASE_METHOD(ItemFixture, "modes: disabled has no queue, sampling does not report")
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

TEST_CASE_METHOD(ItemFixture, "an item that is triggered reports what it has queued until then")
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
    REQUIRE(client.call<SetTriggeringResponse>(links));
    set(1, true);
    CHECK(reported({5}).empty());
}

TEST_CASE("stepped sampling takes the nearest interval, of two the shorter")
{
    const auto policy = server::stepped_sampling();
    const auto revised = [&](double requested) {
        return policy.revise(requested, 4'600ms, false) / 1ms;
    };
    CHECK(policy.intervals.size() == 8 + 9 + 6);
    CHECK(revised(0) == 200);
    CHECK(revised(220) == 200);
    CHECK(revised(250) == 200);
    CHECK(revised(260) == 300);
    CHECK(revised(950) == 900);
    CHECK(revised(951) == 1'000);
    CHECK(revised(9'500) == 9'000);
    CHECK(revised(15'000) == 10'000);
    CHECK(revised(1e300) == 60'000);
    CHECK(revised(-1) == 5'000); // the publishing interval, corrected again
    CHECK(revised(std::nan("")) == 5'000);
}

TEST_CASE("any interval down to a limit is the default")
{
    const server::SamplingPolicy policy;
    CHECK(policy.revise(0, 1s, false) == 10ms);
    CHECK(policy.revise(0, 1s, true) == Duration::zero());
    CHECK(policy.revise(33.3, 1s, true) == 33'300us);
    CHECK(policy.revise(-5, 1s, true) == 1s);
    CHECK(policy.revise(std::nan(""), 1s, false) == 1s);
    CHECK(policy.revise(INFINITY, 1s, false) == 3'600s);
}

TEST_CASE("intervals, counts and queue sizes of any kind are revised")
{
    ItemFixture fixture;
    auto request = fixture.subscription_request();
    const auto revise = [&](double interval, std::uint32_t lifetime, std::uint32_t keep_alive) {
        request.requested_publishing_interval = interval;
        request.requested_lifetime_count = lifetime;
        request.requested_max_keep_alive_count = keep_alive;
        return fixture.client.call<CreateSubscriptionResponse>(request).value();
    };
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double odd : {0.0, -1.0, std::nan(""), -infinity}) {
        const auto response = revise(odd, 0, 0);
        CHECK(response.revised_publishing_interval == 10);
        CHECK(response.revised_max_keep_alive_count == 1);
        CHECK(response.revised_lifetime_count == 3);
    }
    const auto most = revise(1e300, UINT32_MAX, UINT32_MAX);
    CHECK(most.revised_publishing_interval == 3'600'000);
    CHECK(most.revised_max_keep_alive_count == 1);
    CHECK(most.revised_lifetime_count == 3);
    const auto fast = revise(10, UINT32_MAX, UINT32_MAX);
    CHECK(fast.revised_max_keep_alive_count == 360'000);
    CHECK(fast.revised_lifetime_count == 1'080'000);
    auto item = fixture.item_request(fixture.level);
    item.requested_parameters.queue_size = UINT32_MAX;
    CHECK(fixture.monitor(fixture.client, fixture.id, item).revised_queue_size == 10'000);
}

TEST_CASE("a real interval past the revised one by more than 5 % makes Good_Overload")
{
    ItemFixture fixture{server::rd81opc96_subscriptions()};
    const auto made =
        fixture.monitor(fixture.client, fixture.id, fixture.item_request(fixture.level));
    CHECK(made.revised_sampling_interval == 200);
    CHECK(fixture.server.sampling_state().smallest_revised_interval == 200ms);
    CHECK(fixture.next_data(fixture.client, 200ms).size() == 1);
    fixture.advance(210ms); // 5 %
    CHECK(fixture.server.sampling_state().smallest_actual_interval == 210ms);
    CHECK(fixture.next_data(fixture.client, 100ms).empty());
    fixture.advance(300ms);
    CHECK(fixture.server.sampling_state().smallest_actual_interval == 400ms);
    const auto data = fixture.next_data(fixture.client, 100ms);
    REQUIRE(data.size() == 1);
    CHECK(data[0].value == DataValue{Variant{1}, status::Good_Overload});
}
