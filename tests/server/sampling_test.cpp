#include <catch2/catch.hpp>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "subscription_fixture.hpp"

namespace sampling_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct SamplingFixture : SubscriptionFixture {
    TestClient client{log_in()};
    std::uint32_t id{subscribe(client)};
};

/// Writes down what it is told, and when it is read.
class ToldSource final : public server::DataSource {
public:
    struct Call {
        std::vector<server::Monitoring> changes;
        bool was_read_before;
    };

    void read(server::ReadBatch batch) override
    {
        is_read = true;
        for (auto& slot : batch.results()) {
            slot = DataValue{Variant{value}};
        }
        if (is_late) {
            kept.push_back(std::move(batch));
        } else {
            batch.complete();
        }
    }
    void write(server::WriteBatch batch) override
    {
        value = batch.items().back().data->value;
        batch.finish(status::Good);
    }
    void monitoring_changed(std::span<const server::Monitoring> changes) override
    {
        calls.push_back({{changes.begin(), changes.end()}, is_read});
    }
    /// What came since the last time, if it came in one call.
    std::vector<server::Monitoring> take()
    {
        const auto taken = std::exchange(calls, {});
        CHECK(taken.size() <= 1);
        return taken.empty() ? std::vector<server::Monitoring>{} : taken.front().changes;
    }

    std::vector<Call> calls;
    std::vector<server::ReadBatch> kept;
    Variant value{1};
    bool is_late{false};
    bool is_read{false};
};

using Told = std::vector<server::Monitoring>;

/// What has to outlive the server.
struct ToldParts {
    ToldSource source;
};

struct ToldFixture : ToldParts, SubscriptionFixture {
    ToldFixture()
    {
        const std::uint32_t index = server.add_source(source);
        for (std::uint64_t handle : {0U, 1U, 2U}) {
            model::NewVariable variable;
            variable.source = index;
            variable.handle = handle;
            variable.data_type = NodeId{0, id::Int32};
            nodes.push_back(add_variable(std::to_string(handle).c_str(), variable));
        }
        client.emplace(log_in());
        subscription = subscribe(*client);
    }
    [[nodiscard]] MonitoredItemCreateRequest item(std::size_t node, double interval) const
    {
        auto request = item_request(nodes[node]);
        request.requested_parameters.sampling_interval = interval;
        return request;
    }
    std::uint32_t monitor_at(std::size_t node, double interval)
    {
        return monitor(*client, subscription, item(node, interval)).monitored_item_id;
    }
    void remove_item(std::uint32_t id)
    {
        DeleteMonitoredItemsRequest request;
        request.subscription_id = subscription;
        request.monitored_item_ids = {id};
        REQUIRE(client->call<DeleteMonitoredItemsResponse>(request));
    }

    std::vector<NodeId> nodes;
    std::optional<TestClient> client;
    std::uint32_t subscription{0};
};

/// A variable of 0 to 200 with a deadband of 5 %, whose properties are served by `source`.
struct AnalogFixture : ToldParts, SubscriptionFixture {
    explicit AnalogFixture(bool is_late = false)
    {
        source.is_late = is_late;
        source.value = ExtensionObject::from(Range{0, 200});
        property("EURange", id::Range);
        property("EngineeringUnits", id::Structure); // small ones have no EUInformation
        property("Comment", id::Range);
        subscription = subscribe(client);
        auto item = item_request(level);
        DataChangeFilter filter;
        filter.trigger = DataChangeTrigger::StatusValue;
        filter.deadband_type = static_cast<std::uint32_t>(DeadbandType::Percent);
        filter.deadband_value = 5;
        item.requested_parameters.filter = ExtensionObject::from(filter);
        made = monitor(client, subscription, item);
    }
    void property(const char* name, std::uint32_t type)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{0, name};
        node.parent = server.address_space().find(level);
        model::NewVariable variable;
        variable.data_type = NodeId{0, type};
        variable.access_level = model::Access::ReadWrite;
        variable.source = index;
        REQUIRE(server.address_space().add_property(node, variable));
    }
    std::vector<DataValue> reported(Variant value)
    {
        set(0, std::move(value));
        std::vector<DataValue> all;
        for (const auto& notification : next_data(client, 100ms)) {
            all.push_back(notification.value);
        }
        return all;
    }
    StatusCode write(const char* name, Variant value)
    {
        WriteRequest request;
        request.nodes_to_write.resize(1);
        request.nodes_to_write[0].node_id = NodeId{1, name};
        request.nodes_to_write[0].attribute_id = 13;
        request.nodes_to_write[0].value = DataValue{std::move(value)};
        const auto response = operator_client.call<WriteResponse>(request);
        return response ? response->results[0] : response.error();
    }

    NodeId level{add_variable("level", 1)};
    std::uint32_t index{server.add_source(source)};
    TestClient client{log_in()};
    TestClient operator_client{
        log_in(setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt))};
    std::uint32_t subscription{0};
    MonitoredItemCreateResult made;
};

struct LateAnalogFixture : AnalogFixture {
    LateAnalogFixture() : AnalogFixture{true} {}
};

} // namespace

TEST_CASE("each step is its own nearest interval")
{
    const auto policy = server::stepped_sampling();
    for (const auto step : policy.intervals) {
        CHECK(policy.revise(static_cast<double>(step.count()), 1s, false) == step);
        CHECK(policy.revise(-1, step, false) == step);
    }
    CHECK(policy.intervals.front() == 200ms);
    CHECK(policy.intervals.back() == 60s);
    CHECK(policy.revise(0, 1s, true) == 200ms); // scans are not followed
    CHECK(policy.overload_percent == 5);
}

TEST_CASE("the products' limits are those of their manuals")
{
    const auto module = server::rd81opc96_subscriptions();
    CHECK(module.max_subscriptions_per_session == 10);
    CHECK(module.max_subscriptions == 150);
    CHECK(module.max_items == 15'000);
    CHECK(module.max_queue_size == 10);
    CHECK(module.min_publishing_interval == 50ms);
    CHECK(module.min_keep_alive == 5s);
    CHECK(module.min_lifetime == 10s);
    for (const auto& controller : {server::nj501_subscriptions(), server::nx102_subscriptions()}) {
        CHECK(controller.max_subscriptions == 100);
        CHECK(controller.max_items == 2'000);
    }
}

TEST_CASE("no interval is shorter than the MinimumSamplingInterval")
{
    const server::SamplingPolicy any;
    const auto steps = server::stepped_sampling();
    CHECK(any.revise(50, 1s, false, 120) == 120ms);
    CHECK(any.revise(0, 1s, false, 120) == 120ms);
    CHECK(any.revise(-1, 80ms, false, 120) == 120ms);
    CHECK(any.revise(300, 1s, false, 120) == 300ms);
    CHECK(any.revise(1'000, 1s, false, 4'000'000) == 4'000s);
    CHECK(any.revise(0, 1s, true, 120) == Duration::zero()); // by exception
    CHECK(any.revise(50, 1s, true, 120) == 120ms);
    CHECK(steps.revise(250, 1s, false, 250) == 300ms);
    CHECK(steps.revise(200, 1s, false, 700'000) == 700s);
    for (const double none : {0.0, -1.0, -120.0, std::nan("")}) {
        CHECK(any.revise(50, 1s, false, none) == 50ms);
        CHECK(steps.revise(250, 1s, false, none) == 200ms);
    }
    CHECK(any.revise(50, 1s, false, INFINITY) == 365 * 24h);
}

TEST_CASE_METHOD(SamplingFixture, "an item is not sampled faster than its Variable allows")
{
    model::NewVariable variable;
    variable.value = Variant{1};
    variable.data_type = NodeId{0, id::Int32};
    variable.minimum_sampling_interval = 400;
    const NodeId slow = add_variable("slow", variable);
    auto item = item_request(slow);
    const auto made = monitor(client, id, item);
    CHECK(made.revised_sampling_interval == 400);
    item.item_to_monitor.attribute_id = 4; // DisplayName: the limit is the Value's
    CHECK(monitor(client, id, item).revised_sampling_interval == 50);
    ModifyMonitoredItemsRequest request;
    request.subscription_id = id;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.items_to_modify.resize(1);
    request.items_to_modify[0].monitored_item_id = made.monitored_item_id;
    request.items_to_modify[0].requested_parameters.sampling_interval = 10;
    const auto response = client.call<ModifyMonitoredItemsResponse>(request);
    REQUIRE(response);
    CHECK(response->results[0].revised_sampling_interval == 400);
}

TEST_CASE_METHOD(ToldFixture, "what is sampled beside a late source outlives its node")
{
    const char* const name = "a name that does not lie in any small buffer";
    source.is_late = true;
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    const NodeId named = add_variable(name, variable);
    auto item_of_name = item_request(named, 2);
    item_of_name.item_to_monitor.attribute_id = 4; // DisplayName
    REQUIRE(create_items(*client, subscription, {item(0, 50), item_of_name}));
    auto& space = server.address_space();
    REQUIRE(space.remove(space.find(named)));
    REQUIRE(source.kept.size() == 1);
    source.kept.front().complete();
    server.handle_completions(now);
    const auto data = next_data(*client, 100ms);
    REQUIRE(data.size() == 2);
    CHECK(data[1].value.value == Variant{LocalizedText{name}});
}

TEST_CASE_METHOD(ToldFixture, "a source is told what begins, changes and ends, once a call")
{
    const auto made =
        create_items(*client, subscription, {item(0, 200), item(1, 100), item(0, 50)});
    REQUIRE(made);
    REQUIRE(source.calls.size() == 1);
    CHECK_FALSE(source.calls[0].was_read_before);
    CHECK(source.is_read);
    CHECK(source.take() == Told{{0, 50ms}, {1, 100ms}});
    advance(1s);
    monitor_at(0, 50); // a second item changes nothing, nor does a slower one
    monitor_at(1, 500);
    CHECK(source.calls.empty());
    monitor_at(1, 20);
    CHECK(source.take() == Told{{1, 20ms}});

    remove_item(made->results[2].monitored_item_id);
    CHECK(source.calls.empty()); // there is another of 50 ms
    remove_item(made->results[0].monitored_item_id);
    CHECK(source.calls.empty());
    CHECK(remove(*client, subscription) == status::Good);
    CHECK(source.take() == Told{{0, std::nullopt}, {1, std::nullopt}});
    advance(1s);
    CHECK(source.calls.empty());
}

TEST_CASE_METHOD(ToldFixture, "modes and new intervals are told to the source")
{
    const std::uint32_t item_id = monitor_at(2, 50);
    CHECK(source.take() == Told{{2, 50ms}});
    ModifyMonitoredItemsRequest request;
    request.subscription_id = subscription;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.items_to_modify.resize(1);
    request.items_to_modify[0].monitored_item_id = item_id;
    request.items_to_modify[0].requested_parameters.sampling_interval = 400;
    REQUIRE(client->call<ModifyMonitoredItemsResponse>(request));
    CHECK(source.take() == Told{{2, 400ms}});
    CHECK(set_mode(*client, subscription, item_id, MonitoringMode::Sampling) == status::Good);
    CHECK(source.calls.empty());
    CHECK(set_mode(*client, subscription, item_id, MonitoringMode::Disabled) == status::Good);
    CHECK(source.take() == Told{{2, std::nullopt}});
    CHECK(set_mode(*client, subscription, item_id, MonitoringMode::Reporting) == status::Good);
    CHECK(source.take() == Told{{2, 400ms}});
    server.announce_semantics_change(nodes[2]); // it is looked up again, and is where it was
    advance(1s);
    CHECK(source.calls.empty());
}

TEST_CASE_METHOD(ToldFixture, "a source learns of nodes that move, sessions that die and the end")
{
    monitor_at(0, 50);
    CHECK(source.take() == Told{{0, 50ms}});
    auto& space = server.address_space();
    const std::uint32_t index = space.variable(space.find(nodes[0])).source;
    SECTION("bound elsewhere")
    {
        space.bind(space.find(nodes[0]), index, 7);
        advance(50ms);
        CHECK(source.take() == Told{{0, std::nullopt}, {7, 50ms}});
        REQUIRE(space.remove(space.find(nodes[0])));
        advance(50ms);
        CHECK(source.take() == Told{{7, std::nullopt}});
    }
    SECTION("a right that is lost and given back")
    {
        space.set_access_level(space.find(nodes[0]), model::Access::Read, model::Access::None);
        advance(50ms);
        CHECK(source.take() == Told{{0, std::nullopt}});
        space.set_access_level(space.find(nodes[0]), model::Access::Read);
        advance(50ms);
        CHECK(source.take() == Told{{0, 50ms}});
    }
    SECTION("CloseSession")
    {
        CloseSessionRequest request;
        request.delete_subscriptions = true;
        CHECK(client->status_of<CloseSessionResponse>(request) == status::Good);
        CHECK(source.take() == Told{{0, std::nullopt}});
    }
    SECTION("a session that times out, and its Subscription later")
    {
        advance(61s);
        CHECK(server.session_count() == 0);
        for (int i = 0; i < 100 && server.subscription_count() != 0; ++i) {
            advance(100ms);
        }
        CHECK(server.subscription_count() == 0);
        CHECK(source.take() == Told{{0, std::nullopt}});
    }
    SECTION("the server's end")
    {
        client.reset();
        {
            const server::Server ended = std::move(server);
        }
        CHECK(source.take() == Told{{0, std::nullopt}});
    }
}

TEST_CASE_METHOD(AnalogFixture, "a deadband in percent of an EURange that a source has")
{
    CHECK(made.status_code == status::Good);
    CHECK(reported(1).size() == 1);
    CHECK(reported(11).empty());
    CHECK(reported(12).size() == 1);
    source.value = Variant{"no range"};
    auto item = item_request(level);
    DataChangeFilter filter;
    filter.deadband_type = static_cast<std::uint32_t>(DeadbandType::Percent);
    filter.deadband_value = 5;
    item.requested_parameters.filter = ExtensionObject::from(filter);
    CHECK(monitor(client, subscription, item).status_code == status::Bad_DeadbandFilterInvalid);
}

TEST_CASE_METHOD(LateAnalogFixture, "until a late source has answered every change is reported")
{
    CHECK(made.status_code == status::Good);
    REQUIRE(source.kept.size() == 1);
    CHECK(reported(1).size() == 1);
    CHECK(reported(2).size() == 1);
    source.kept[0].complete();
    server.handle_completions(now);
    CHECK(reported(12).empty());
    CHECK(reported(13).size() == 1);
    // The answer may come when nobody wants it any more.
    server.announce_semantics_change(level);
    REQUIRE(source.kept.size() == 2);
    CHECK(remove(client, subscription) == status::Good);
    source.kept[1].complete();
    server.handle_completions(now);
}

TEST_CASE_METHOD(AnalogFixture,
                 "a client's Write of what a value means is told with its next value",
                 "[unit:Base Info SemanticChange Bit][unit:Data Access Semantic Changes]")
{
    const StatusCode semantics_changed{0x4000};
    CHECK(reported(1).size() == 1);
    CHECK(write("EURange", ExtensionObject::from(Range{0, 20})) == status::Good);
    auto told = reported(1);
    REQUIRE(told.size() == 1);
    CHECK(told[0] == DataValue{Variant{1}, semantics_changed});
    CHECK(reported(3).size() == 1); // 5 % of 20 now
    CHECK(write("EngineeringUnits", ExtensionObject::from(EUInformation{})) == status::Good);
    told = reported(3);
    REQUIRE(told.size() == 1);
    CHECK(told[0].status == semantics_changed);
    CHECK(write("Comment", ExtensionObject::from(Range{0, 1})) == status::Good);
    CHECK(write("EURange", Variant{3}) == status::Bad_TypeMismatch);
    CHECK(reported(3).empty());
}

TEST_CASE_METHOD(AnalogFixture, "what a value means is told although the client that wrote it left",
                 "[unit:Data Access Semantic Changes]")
{
    struct HeldWrites final : server::DataSource {
        void read(server::ReadBatch) override {}
        void write(server::WriteBatch batch) override { kept.push_back(std::move(batch)); }
        std::vector<server::WriteBatch> kept;
    };
    static HeldWrites held;
    const auto add = [&](const char* name, std::uint32_t of) {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{0, name};
        node.parent = server.address_space().find(level);
        model::NewVariable variable;
        variable.value = Variant{1};
        variable.data_type = NodeId{0, id::Int32};
        variable.access_level = model::Access::ReadWrite;
        variable.source = of;
        REQUIRE(server.address_space().add_property(node, variable));
        WriteValue written;
        written.node_id = node.id;
        written.attribute_id = 13;
        written.value = DataValue{Variant{2}};
        return written;
    };
    WriteRequest request;
    request.nodes_to_write = {add("Title", model::no_source), add("Slow", server.add_source(held))};
    CHECK(reported(1).size() == 1);
    static_cast<void>(operator_client.send(request));
    REQUIRE(held.kept.size() == 1);
    CHECK(operator_client.close_session() == status::Good);
    const auto told = reported(1);
    REQUIRE(told.size() == 1);
    CHECK(told[0] == DataValue{Variant{1}, StatusCode{0x4000}}); // SemanticsChanged
    held.kept.clear();
}

} // namespace sampling_test
