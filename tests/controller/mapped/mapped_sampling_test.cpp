#include "mapped_fixture.hpp"

namespace mapped_sampling_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct Fixture : MappedFixture {
    explicit Fixture(SamplingMode mode = SamplingMode::Standard)
        : MappedFixture{options_of(mode), config()}
    {
        plc->add("Speed", LabelType::Word, std::int16_t{10});
        plc->add("Other", LabelType::Word, std::int16_t{20});
        speed = add("speed", id::Int16, {"Speed"});
        other = add("other", id::Int16, {"Other"});
    }
    [[nodiscard]] static MappedOptions options_of(SamplingMode mode)
    {
        MappedOptions options;
        options.sampling = mode;
        options.limits.max_monitored_size = 2'048;
        return options;
    }
    [[nodiscard]] static server::ServerConfig config()
    {
        server::ServerConfig config = insecure_config();
        config.limits.subscriptions.sampling = server::stepped_sampling();
        return config;
    }
    void subscribe()
    {
        CreateSubscriptionRequest request;
        request.requested_publishing_interval = 200;
        request.requested_lifetime_count = 1'000;
        request.requested_max_keep_alive_count = 100;
        request.publishing_enabled = true;
        const auto made = client->call<CreateSubscriptionResponse>(request);
        REQUIRE(made);
        subscription = made->subscription_id;
    }
    Array<MonitoredItemCreateResult> monitor(const std::vector<NodeId>& nodes)
    {
        CreateMonitoredItemsRequest request;
        request.subscription_id = subscription;
        request.timestamps_to_return = TimestampsToReturn::Source;
        for (const NodeId& node : nodes) {
            MonitoredItemCreateRequest item;
            item.item_to_monitor = value_of(node);
            item.monitoring_mode = MonitoringMode::Reporting;
            item.requested_parameters.client_handle =
                static_cast<std::uint32_t>(request.items_to_create.size());
            item.requested_parameters.sampling_interval = 200;
            item.requested_parameters.queue_size = 1;
            request.items_to_create.push_back(item);
        }
        const auto response = client->call<CreateMonitoredItemsResponse>(request);
        REQUIRE(response);
        return response->results;
    }
    StatusCode remove_item(std::uint32_t item)
    {
        DeleteMonitoredItemsRequest request;
        request.subscription_id = subscription;
        request.monitored_item_ids = {item};
        return client->call<DeleteMonitoredItemsResponse>(request)->results[0];
    }
    /// What is published 200 ms later, in the order of client handles.
    std::vector<DataValue> next()
    {
        complete();
        client->send(PublishRequest{});
        advance(200ms);
        complete();
        advance(0ms);
        client->run();
        std::vector<DataValue> all;
        while (!client->messages.empty()) {
            const auto response =
                client->take<PublishResponse>(client->messages.front().request_id);
            REQUIRE(response);
            for (const ExtensionObject& part : response->notification_message.notification_data) {
                if (const auto* data = part.get_if<DataChangeNotification>()) {
                    for (const auto& item : data->monitored_items) {
                        all.push_back(item.value);
                    }
                }
            }
        }
        return all;
    }

    NodeId speed;
    NodeId other;
    std::uint32_t subscription{0};
};

struct ItemsMode : Fixture {
    ItemsMode() : Fixture{SamplingMode::MonitoredItems} {}
};
struct AllMode : Fixture {
    AllMode() : Fixture{SamplingMode::AllVariables} {}
};

} // namespace

TEST_CASE_METHOD(Fixture, "8.3 Subscription: Variables of one interval are read in one", "[8.3]")
{
    source.start();
    subscribe();
    monitor({speed, other});
    CHECK(next().size() == 2);
    plc->sizes.clear();
    plc->set("Other", std::int16_t{21});
    plc->time = DateTime{2'000'000};
    const auto values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].value == Variant{std::int16_t{21}});
    CHECK(values[0].source_timestamp == DateTime{2'000'000});
    CHECK(plc->sizes == std::vector<std::size_t>{2});
}

TEST_CASE_METHOD(Fixture, "8.1 CreateMonitoredItems: the sizes of all items have a limit", "[8.1]")
{
    plc->add("T", LabelType::UnsignedWord, std::uint16_t{0});
    const NodeId none = add("none", id::Int16, 0, {own("none"), nullptr, {"T"}, {}});
    // 512 of two bytes make up half of what there is.
    std::vector<std::string> labels(512);
    labels[0] = "Speed";
    const NodeId list = add("list", id::Int16, labels);
    source.start();
    subscribe();
    CHECK(monitor({none})[0].status_code == status::Bad_NotSupported);
    const auto made = monitor({list, list, speed});
    CHECK(made[0].status_code == status::Good);
    CHECK(made[1].status_code == status::Good);
    CHECK(made[2].status_code == status::Bad_TooManyMonitoredItems);
    REQUIRE(remove_item(made[0].monitored_item_id) == status::Good);
    CHECK(monitor({speed})[0].status_code == status::Good);
}

TEST_CASE_METHOD(Fixture, "8.1 ModifyMonitoredItems: the PLC is read as often as is asked then",
                 "[8.1]")
{
    source.start();
    subscribe();
    const auto items = monitor({speed});
    CHECK(next().size() == 1);
    ModifyMonitoredItemsRequest request;
    request.subscription_id = subscription;
    MonitoredItemModifyRequest item;
    item.monitored_item_id = items[0].monitored_item_id;
    item.requested_parameters.sampling_interval = 600;
    item.requested_parameters.queue_size = 1;
    request.items_to_modify = {item};
    const auto modified = client->call<ModifyMonitoredItemsResponse>(request);
    REQUIRE(modified);
    CHECK(modified->results[0].status_code == status::Good);
    CHECK(modified->results[0].revised_sampling_interval == 600);
    static_cast<void>(next());
    plc->sizes.clear();
    for (int i = 0; i < 9; ++i) {
        static_cast<void>(next());
    }
    CHECK(plc->sizes.size() == 3);
}

TEST_CASE_METHOD(Fixture, "8.1 DeleteMonitoredItems: the PLC is not read for them any more",
                 "[8.1]")
{
    source.start();
    subscribe();
    const auto items = monitor({speed, other});
    CHECK(next().size() == 2);
    CHECK(remove_item(items[1].monitored_item_id) == status::Good);
    plc->sizes.clear();
    static_cast<void>(next());
    CHECK(plc->sizes == std::vector<std::size_t>{1});
    CHECK(remove_item(items[0].monitored_item_id) == status::Good);
    plc->sizes.clear();
    static_cast<void>(next());
    CHECK(plc->sizes.empty());
}

TEST_CASE_METHOD(Fixture, "10.3 Good_Overload with the last value while labels are updated",
                 "[8.3][10.3]")
{
    source.start();
    subscribe();
    monitor({speed});
    CHECK(next().size() == 1);
    plc->is_prompt = false;
    plc->set("Speed", std::int16_t{11});
    plc->listener->labels_changed();
    const auto during = next();
    REQUIRE(during.size() == 1);
    CHECK(during[0].status == status::Good_Overload);
    CHECK(during[0].value == Variant{std::int16_t{10}});
    plc->is_prompt = true;
    while (!plc->requests.empty()) {
        plc->answer();
    }
    const auto after = next();
    REQUIRE(after.size() == 1);
    CHECK(after[0].status == status::Good);
    CHECK(after[0].value == Variant{std::int16_t{11}});
}

TEST_CASE_METHOD(ItemsMode, "9.12 Monitored items only: the PLC samples what is monitored",
                 "[8.3][9.12]")
{
    source.start();
    CHECK(plc->started[LabelRequest::Kind::Sample] == 0);
    subscribe();
    const auto made = monitor({speed});
    complete();
    CHECK(plc->sample_offsets.size() == 1);
    plc->sample(100);
    static_cast<void>(next());
    plc->set("Speed", std::int16_t{12}); // not sampled yet
    plc->set("Other", std::int16_t{22});
    const int reads = plc->started[LabelRequest::Kind::Read];
    CHECK(next().empty());
    plc->sample(120);
    const auto values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].value == Variant{std::int16_t{12}});
    CHECK(values[0].source_timestamp == DateTime{120 * 10'000});
    CHECK(plc->started[LabelRequest::Kind::Read] == reads);
    CHECK(read(other).value == Variant{std::int16_t{22}});
    CHECK(plc->started[LabelRequest::Kind::Read] == reads + 1);
    REQUIRE(remove_item(made[0].monitored_item_id) == status::Good);
    complete();
    CHECK(plc->sample_offsets.empty());
}

TEST_CASE_METHOD(ItemsMode, "8.3 High-speed sampling: stops until a change is done", "[8.3][9.12]")
{
    source.start();
    subscribe();
    monitor({speed});
    complete();
    plc->sample(100);
    static_cast<void>(next());
    plc->is_prompt = false;
    const int reads = plc->started[LabelRequest::Kind::Read];
    monitor({other}); // its first value has to be read
    CHECK(plc->started[LabelRequest::Kind::Sample] == 2);
    CHECK(plc->started[LabelRequest::Kind::Read] == reads + 1);
    plc->is_prompt = true;
    while (!plc->requests.empty()) {
        plc->answer();
    }
    complete();
    CHECK(plc->sample_offsets.size() == 2);
    plc->sample(120);
    static_cast<void>(next());
    CHECK(plc->started[LabelRequest::Kind::Read] == reads + 1);
}

TEST_CASE_METHOD(ItemsMode, "8.3 High-speed sampling: Good_Overload without the 5 %", "[8.3]")
{
    source.start();
    subscribe();
    monitor({speed});
    complete();
    plc->sample(1'000);
    static_cast<void>(next());
    plc->sample(1'200); // as revised
    CHECK(next().empty());
    plc->sample(1'401);
    const auto values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].status == status::Good_Overload);
}

TEST_CASE_METHOD(AllMode, "9.12 All Variables: Reads get the newest scan too", "[8.3][9.12]")
{
    source.start();
    CHECK(plc->sample_offsets.size() == 2);
    CHECK(read(speed).value == Variant{std::int16_t{10}}); // read, as there was no scan
    plc->set("Speed", std::int16_t{13});
    plc->sample(100);
    const int reads = plc->started[LabelRequest::Kind::Read];
    const auto value = read(speed);
    CHECK(value.value == Variant{std::int16_t{13}});
    CHECK(value.source_timestamp == DateTime{100 * 10'000});
    CHECK(plc->started[LabelRequest::Kind::Read] == reads);
    REQUIRE(write({{speed, Variant{std::int16_t{14}}}})[0] == status::Good);
    CHECK(plc->get<std::int16_t>("Speed") == 14);
}

TEST_CASE_METHOD(AllMode, "8.3 High-speed sampling: errors", "[8.3]")
{
    const std::pair<LabelStatus, MappedErrorCode> table[] = {
        {LabelStatus::TooManyPoints, MappedErrorCode::TooManyPoints},
        {LabelStatus::UnsampledDevice, MappedErrorCode::UnsampledDevice},
        {LabelStatus::SamplingUnknown, MappedErrorCode::SamplingUnsupported},
    };
    plc->labels["Other"].is_unsampled_device = true;
    for (const auto& [fault, code] : table) {
        plc->sample_fault = fault;
        book.errors.clear();
        source.start();
        CHECK(book.errors == std::vector{code});
        CHECK(read(speed).status == status::Bad_NoCommunication);
        CHECK(book.label == (code == MappedErrorCode::UnsampledDevice ? "Other" : ""));
    }
    plc->sample_fault = LabelStatus::Done;
    source.start();
    CHECK(read(speed).status == status::Good);
}

TEST_CASE_METHOD(Fixture, "8.3 Subscription: samples wait where the PLC takes no more requests",
                 "[8.3]")
{
    source.start();
    complete();
    subscribe();
    plc->is_prompt = false;
    plc->room = 2;
    // Each request samples its items for the first time.
    for (std::size_t i = 0; i < 6; ++i) {
        REQUIRE(monitor({i % 2 == 0 ? speed : other})[0].status_code.is_good());
    }
    CHECK(plc->requests.size() == 2);
    while (!plc->requests.empty()) {
        CHECK(plc->requests.size() <= 2);
        plc->answer();
        complete();
    }
    plc->is_prompt = true;
    const auto values = next();
    REQUIRE(values.size() == 6);
    for (const DataValue& value : values) {
        CHECK(value.status.is_good());
    }
}

TEST_CASE_METHOD(Fixture, "8.3 Subscription: samples that nobody makes room for are refused",
                 "[8.3]")
{
    source.start();
    complete();
    subscribe();
    plc->room = 0;
    REQUIRE(monitor({speed})[0].status_code.is_good());
    const auto values = next();
    REQUIRE(values.size() == 1);
    CHECK(values[0].status == status::Bad_TooManyOperations);
}

TEST_CASE_METHOD(Fixture, "8.3 Subscription: samples that wait for room end with the source",
                 "[8.3]")
{
    source.start();
    complete();
    subscribe();
    plc->is_prompt = false;
    plc->room = 1;
    REQUIRE(monitor({speed})[0].status_code.is_good());
    REQUIRE(monitor({other})[0].status_code.is_good());
    complete();
    source.stop();
    const auto values = next();
    REQUIRE(values.size() == 2);
    CHECK(values[0].status == status::Bad_NoCommunication);
    CHECK(values[1].status == status::Bad_NoCommunication);
}

} // namespace mapped_sampling_test
