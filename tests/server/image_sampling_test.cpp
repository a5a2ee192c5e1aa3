#include <catch2/catch.hpp>

#include <busbar/server/process_image.hpp>
#include <busbar/server/running_server.hpp>

#include "subscription_fixture.hpp"
#include "support/slow_server.hpp"

namespace image_sampling_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 100ms;
constexpr StatusCode overflow{0x0480};

/// A task with a few variables, and what serves them.
struct Plc {
    explicit Plc(Duration scan_cycle)
    {
        server::ImageLayout layout;
        button = layout.add({BuiltInType::Boolean, {}}).value();
        level = layout.add({BuiltInType::Int32, {}}).value();
        row = layout.add({BuiltInType::Int32, {3}}).value();
        name = layout.add({BuiltInType::String, {}, 16}).value();
        const std::vector<server::ImageVariable> members{{BuiltInType::Int32},
                                                         {BuiltInType::String, {}, 4}};
        points = layout
                     .add({BuiltInType::ExtensionObject,
                           {2},
                           0,
                           server::ImageStructure::create(NodeId{1, 99}, members).value()})
                     .value();
        word = layout.add({BuiltInType::Int16, {}}).value();
        real = layout.add({BuiltInType::Double, {}}).value();
        server::ImageOptions options;
        options.cycle = scan_cycle;
        image = server::ProcessImage::create(std::move(layout), options);
        source = std::make_unique<server::ImageSource>(image);
    }
    void scan()
    {
        image->begin_scan();
        image->publish(time);
        time.ticks += 10;
    }

    std::uint32_t button, level, row, name, points, word, real;
    std::shared_ptr<server::ProcessImage> image;
    std::unique_ptr<server::ImageSource> source;
    CountingWaker waker_of_plc;
    DateTime time{today};
};

struct ImageFixture : Plc, ServerFixture {
    explicit ImageFixture(Duration scan_cycle = Duration::zero())
        : Plc{scan_cycle}, ServerFixture{waker_of_plc, insecure_config()}
    {
        const auto index = server.add_source(*source);
        add(index, button, id::Boolean, -1);
        add(index, level, id::Int32, -1);
        add(index, row, id::Int32, 1);
        add(index, name, id::String, -1);
        add(index, points, id::Structure, 1);
        add(index, word, id::Int16, -1);
        add(index, real, id::Double, -1);
        subscription =
            client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
                .value()
                .subscription_id;
    }
    void add(std::uint32_t source_index, std::uint32_t handle, std::uint32_t type, int rank)
    {
        model::NewVariable variable;
        variable.source = source_index;
        variable.handle = handle;
        variable.data_type = NodeId{0, type};
        variable.value_rank = rank;
        model::NewNode node;
        node.id = NodeId{1, handle};
        node.browse_name = QualifiedName{1, String{std::to_string(handle)}};
        node.parent = server.address_space().find(id::ObjectsFolder);
        REQUIRE(server.address_space().add_variable(node, variable));
    }
    MonitoredItemCreateResult monitor(std::uint32_t handle, double interval,
                                      const char* range = nullptr)
    {
        auto item = SubscriptionFixture::item_request(NodeId{1, handle}, handle);
        item.requested_parameters.sampling_interval = interval;
        item.requested_parameters.queue_size = 20;
        item.item_to_monitor.index_range = range != nullptr ? String{range} : String{};
        const auto made =
            SubscriptionFixture::monitor(client, subscription, item, TimestampsToReturn::Source);
        CHECK(made.status_code == status::Good);
        return made;
    }
    /// What a cycle brings; a request is there for it.
    std::vector<DataValue> next()
    {
        client.messages.clear();
        SubscriptionFixture::publish(client);
        advance(cycle);
        client.run();
        std::vector<DataValue> values;
        while (!client.messages.empty()) {
            const auto response = SubscriptionFixture::take(client, client.messages[0].request_id);
            if (!response) {
                break;
            }
            for (const auto& one : SubscriptionFixture::data(response->notification_message)) {
                values.push_back(one.value);
            }
        }
        return values;
    }
    std::vector<Variant> next_values()
    {
        std::vector<Variant> values;
        for (DataValue& one : next()) {
            values.push_back(std::move(one.value));
        }
        return values;
    }

    TestClient client{log_in()};
    std::uint32_t subscription{0};
};

/// The server knows the time from scan to scan.
struct CycleFixture : ImageFixture {
    CycleFixture() : ImageFixture{cycle} {}
};

} // namespace

TEST_CASE_METHOD(ImageFixture, "values of each size are reported when they change, and only then")
{
    scan();
    for (const std::uint32_t handle : {button, word, level, real}) {
        monitor(handle, 0);
    }
    CHECK(next_values().size() == 4);
    const auto values_after_scan = [&] {
        scan();
        server.handle_completions(now);
        return next_values();
    };
    CHECK(values_after_scan().empty());
    server::ImageMemory& memory = image->memory();
    memory.value<bool>(button) = true;
    CHECK(values_after_scan() == std::vector<Variant>{true});
    memory.value<std::int16_t>(word) = 0x0100;
    CHECK(values_after_scan() == std::vector<Variant>{Variant{std::int16_t{0x0100}}});
    memory.value<std::int32_t>(level) = 0x0100'0000;
    CHECK(values_after_scan() == std::vector<Variant>{Variant{std::int32_t{0x0100'0000}}});
    memory.value<double>(real) = 0.5;
    CHECK(values_after_scan() == std::vector<Variant>{Variant{0.5}});
    CHECK(values_after_scan().empty());
}

TEST_CASE_METHOD(ImageFixture, "a pulse of one scan is seen by an item that follows the scans")
{
    scan();
    CHECK(monitor(button, 0).revised_sampling_interval == 0);
    CHECK(next_values() == std::vector<Variant>{false});
    const int woken = waker_of_plc.count;
    for (const bool pressed : {false, true, false, false}) {
        image->memory().value<bool>(button) = pressed;
        scan();
    }
    CHECK(waker_of_plc.count == woken + 4);
    server.handle_completions(now);
    const auto values = next();
    REQUIRE(values.size() == 2);
    CHECK(values[0].value == Variant{true});
    CHECK(values[1].value == Variant{false});
    CHECK(values[1].source_timestamp.ticks == values[0].source_timestamp.ticks + 10);
}

TEST_CASE_METHOD(CycleFixture, "an interval of one scan misses no scan")
{
    scan();
    const auto interval = GENERATE(100.0, 50.0);
    const auto made = monitor(level, interval);
    CHECK(made.revised_sampling_interval == interval);
    std::vector<Variant> expected{0};
    std::vector<Variant> values = next_values();
    for (int i = 1; i <= 60; ++i) {
        image->memory().value<std::int32_t>(level) = i;
        expected.emplace_back(i);
        scan();
        server.handle_completions(now);
        if (i % 3 == 0) { // scans are faster than the clock of the server
            const auto more = next_values();
            values.insert(values.end(), more.begin(), more.end());
        }
    }
    CHECK(values == expected);
}

TEST_CASE_METHOD(CycleFixture, "an interval longer than a scan has a timer of its own")
{
    scan();
    monitor(level, 200);
    next();
    for (int i = 1; i <= 10; ++i) {
        image->memory().value<std::int32_t>(level) = i;
        scan();
        server.handle_completions(now);
    }
    auto values = next_values(); // of 100 ms each
    const auto more = next_values();
    values.insert(values.end(), more.begin(), more.end());
    CHECK(values == std::vector<Variant>{10});
}

TEST_CASE_METHOD(ImageFixture, "a filter on the timestamp sees changes only")
{
    scan();
    auto item = SubscriptionFixture::item_request(NodeId{1, level}, level);
    item.requested_parameters.sampling_interval = 0;
    item.requested_parameters.queue_size = 20;
    DataChangeFilter filter;
    filter.trigger = DataChangeTrigger::StatusValueTimestamp;
    item.requested_parameters.filter = ExtensionObject::from(filter);
    CHECK(SubscriptionFixture::monitor(client, subscription, item, TimestampsToReturn::Source)
              .status_code == status::Good);
    CHECK(next().size() == 1);
    for (int i = 0; i < 5; ++i) {
        scan();
        server.handle_completions(now);
    }
    CHECK(next().empty());
    image->memory().value<std::int32_t>(level) = 1;
    const DateTime changed = time;
    scan();
    scan();
    server.handle_completions(now);
    const auto values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].source_timestamp == changed);
}

TEST_CASE_METHOD(ImageFixture, "each change of each scan arrives once and in order")
{
    scan();
    monitor(level, 0);
    std::vector<Variant> expected{0};
    std::vector<Variant> values;
    for (int i = 1; i <= 200; ++i) {
        image->memory().value<std::int32_t>(level) = i;
        expected.emplace_back(i);
        scan();
        if (i % 3 == 0) { // a server that is not always in time
            server.handle_completions(now);
        }
        if (i % 9 == 0) {
            const auto more = next_values();
            values.insert(values.end(), more.begin(), more.end());
        }
    }
    server.handle_completions(now);
    const auto more = next_values();
    values.insert(values.end(), more.begin(), more.end());
    CHECK(values == expected);
}

TEST_CASE_METHOD(ImageFixture, "scans that nobody takes do not stop the task")
{
    scan();
    monitor(level, 0);
    for (int i = 1; i <= 50; ++i) {
        image->memory().value<std::int32_t>(level) = i;
        scan();
    }
    server.handle_completions(now);
    // What the queue had no place for is lost, but not the latest scan.
    const auto values = next();
    REQUIRE(values.size() == 2 + image->options().max_queued_scans);
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        CHECK(values[i].value == Variant{static_cast<std::int32_t>(i)});
        CHECK(values[i].status == status::Good);
    }
    CHECK(values.back().value == Variant{50});
    CHECK(values.back().status == overflow);
    // Without items nothing is kept, and nobody is woken.
    DeleteMonitoredItemsRequest remove;
    remove.subscription_id = subscription;
    remove.monitored_item_ids = {1};
    REQUIRE(client.call<DeleteMonitoredItemsResponse>(remove));
    server.handle_completions(now);
    const int woken = waker_of_plc.count;
    scan();
    CHECK(waker_of_plc.count == woken);
    CHECK_FALSE(image->next_scan());
}

TEST_CASE_METHOD(ImageFixture, "values that were lost between scans are told with the next value")
{
    scan();
    monitor(level, 0);
    monitor(button, 0);
    auto single = SubscriptionFixture::item_request(NodeId{1, level}, 9);
    single.requested_parameters.sampling_interval = 0;
    SubscriptionFixture::monitor(client, subscription, single);
    CHECK(next().size() == 3);
    const auto lose_scans = [&](std::int32_t last) {
        for (std::int32_t i = last - 9; i <= last; ++i) {
            image->memory().value<std::int32_t>(level) = i;
            scan();
        }
        server.handle_completions(now);
    };
    lose_scans(10);
    auto values = next();
    REQUIRE(values.size() == 6); // the queue of one has its last only
    CHECK(values[3].value == Variant{4});
    CHECK(values[3].status == status::Good);
    CHECK(values[4].value == Variant{10});
    CHECK(values[4].status == overflow);
    CHECK(values[5].value == Variant{10});
    CHECK(values[5].status == status::Good);

    // Nobody knows whether the button was pressed meanwhile; its next value says so, once.
    for (const bool pressed : {true, false}) {
        image->memory().value<bool>(button) = pressed;
        scan();
    }
    server.handle_completions(now);
    values = next();
    REQUIRE(values.size() == 2);
    CHECK(values[0].value == Variant{true});
    CHECK(values[0].status == overflow);
    CHECK(values[1].status == status::Good);
}

TEST_CASE_METHOD(ImageFixture, "items that follow the scans learn that the task has stopped")
{
    scan();
    monitor(level, 0);
    CHECK(next().size() == 1);
    const int woken = waker_of_plc.count;
    image->halt();
    CHECK(waker_of_plc.count == woken + 1);
    server.handle_completions(now);
    auto values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].value == Variant{0});
    CHECK(values[0].status == status::Uncertain_LastUsableValue);
    server.handle_completions(now);
    CHECK(next().empty());
    scan();
    server.handle_completions(now);
    values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].status == status::Good);
}

TEST_CASE_METHOD(ImageFixture, "an item that is new begins with the latest scan")
{
    scan();
    monitor(level, 0);
    CHECK(next().size() == 1);
    for (int i = 1; i <= 3; ++i) {
        image->memory().value<std::int32_t>(level) = i;
        scan();
    }
    monitor(level, 0);
    server.handle_completions(now);
    const auto values = next_values();
    REQUIRE(values.size() >= 4);
    CHECK(values.back() == Variant{3});
    CHECK(std::count(values.begin(), values.end(), Variant{1}) <= 2);
    image->memory().value<std::int32_t>(level) = 4;
    scan();
    server.handle_completions(now);
    CHECK(next_values() == std::vector<Variant>{4, 4});
}

TEST_CASE_METHOD(ImageFixture, "an item that is created while scans wait does not go back to them")
{
    scan();
    monitor(button, 0);
    CHECK(next_values() == std::vector<Variant>{false});
    for (const int value : {1, 2}) {
        image->memory().value<std::int32_t>(level) = value;
        scan();
    }
    monitor(level, 0);
    server.handle_completions(now);
    CHECK(next_values() == std::vector<Variant>{1, 2});
}

TEST_CASE_METHOD(ImageFixture, "an interval samples the latest scan, without a call of the source")
{
    monitor(level, 50);
    monitor(row, 50);
    monitor(row, 50, "1");
    monitor(name, 50);
    auto values = next();
    REQUIRE(values.size() == 4);
    for (const DataValue& value : values) {
        CHECK(value.status == status::Bad_NoCommunication);
    }
    image->memory().set_text(name, "pump");
    scan();
    values = next();
    REQUIRE(values.size() == 4);
    CHECK(values[0] == DataValue{Variant{0}, status::Good, today});
    CHECK(values[1].value == Variant{Array<std::int32_t>{0, 0, 0}});
    CHECK(values[2].value == Variant{Array<std::int32_t>{0}});
    CHECK(values[3].value == Variant{"pump"});
    scan();
    CHECK(next().empty());
    image->memory().values<std::int32_t>(row)[0] = 4;
    scan();
    CHECK(next_values() == std::vector<Variant>{Array<std::int32_t>{4, 0, 0}});
    image->halt();
    values = next();
    REQUIRE(values.size() == 4);
    for (const DataValue& value : values) {
        CHECK(value.status == status::Uncertain_LastUsableValue);
    }
}

TEST_CASE_METHOD(ImageFixture, "structures are sampled scan by scan, as a whole and by element")
{
    scan();
    monitor(points, 0);
    monitor(points, 0, "1");
    const auto first = next_values();
    REQUIRE(first.size() == 2);
    CHECK(first[0] == image->memory().load(points));
    scan();
    server.handle_completions(now);
    CHECK(next().empty());
    std::vector<Variant> expected;
    for (int i = 1; i <= 2; ++i) {
        const server::StructureView point = image->memory().structure(points, 0);
        point.value<std::int32_t>(0) = i;
        CHECK(point.set_text(1, std::to_string(i)));
        expected.push_back(image->memory().load(points));
        scan();
    }
    server.handle_completions(now);
    CHECK(next_values() == expected); // the other element has not changed
    image->memory().structure(points, 1).value<std::int32_t>(0) = 9;
    scan();
    server.handle_completions(now);
    const auto values = next_values();
    REQUIRE(values.size() == 2);
    const auto* const whole = values[0].array_if<ExtensionObject>();
    REQUIRE(whole != nullptr);
    CHECK(values[1] == Variant{Array<ExtensionObject>{(*whole)[1]}});
}

TEST_CASE_METHOD(ImageFixture, "scans of a suspended server's task are not told")
{
    scan();
    monitor(level, 0);
    monitor(level, 50);
    CHECK(next_values() == std::vector<Variant>{0, 0});
    const server::RunningServer running{server};
    REQUIRE(running.change_state(ServerState::Suspended, "", {}));
    image->memory().value<std::int32_t>(level) = 1;
    scan();
    server.handle_completions(now);
    auto values = next();
    REQUIRE(values.size() == 2);
    for (const DataValue& value : values) {
        CHECK(value.status == status::Bad_OutOfService);
        CHECK(value.value.is_null());
    }
    REQUIRE(running.change_state(ServerState::Running, "", {}));
    scan();
    server.handle_completions(now);
    CHECK(next_values() == std::vector<Variant>{1, 1});
}

TEST_CASE_METHOD(ImageFixture, "what was added is sampled from its first scan on")
{
    scan();
    server::ImageLayout more;
    static_cast<void>(more.add({BuiltInType::Int32}));
    const auto added =
        image->add_variables(more, [](server::ImageMemory&) { return StatusCode{}; });
    REQUIRE(added);
    add(source->index(), added->first_handle, id::Int32, -1);
    monitor(added->first_handle, 0);
    auto values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].status == status::Bad_WaitingForInitialData);
    scan();
    server.handle_completions(now);
    CHECK(next_values() == std::vector<Variant>{0});
    scan();
    server.handle_completions(now);
    CHECK(next().empty());
    added->memory->value<std::int32_t>(0) = 4;
    scan();
    server.handle_completions(now);
    CHECK(next_values() == std::vector<Variant>{4});
}

} // namespace image_sampling_test
