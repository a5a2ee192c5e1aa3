#include <map>
#include <set>

#include <busbar/server/process_image.hpp>

#include "failure_cases.hpp"
#include "support/failing_worlds.hpp"

namespace image_item_failure_test {

/// Items of a process image with the k-th allocation of a request failing: the same request
/// goes through afterwards and does what it says, and when the items are gone nothing is counted.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t item_size = 10;
constexpr std::size_t most_items = 12;
constexpr std::uint32_t variable_count = 3;

/// Serves an image, and knows what is monitored of it.
class ToldImageSource final : public server::DataSource {
public:
    explicit ToldImageSource(const std::shared_ptr<server::ProcessImage>& image) : inner_{image} {}

    [[nodiscard]] server::DataSourceOptions options() const override
    {
        server::DataSourceOptions options = inner_.options();
        options.max_monitored_size = most_items * item_size;
        return options;
    }
    void read(server::ReadBatch batch) override { inner_.read(std::move(batch)); }
    void write(server::WriteBatch batch) override { inner_.write(std::move(batch)); }
    void attach(server::Waker* waker) override { inner_.attach(waker); }
    void handle_completions() override { inner_.handle_completions(); }
    [[nodiscard]] server::ProcessImage* process_image() override { return inner_.process_image(); }
    [[nodiscard]] Result<std::size_t> monitored_size(std::uint64_t) const override
    {
        return item_size;
    }
    void monitoring_changed(std::span<const server::Monitoring> changes) override
    {
        const Uncounted in_test;
        for (const server::Monitoring& change : changes) {
            monitored.erase(change.handle);
            if (change.interval) {
                monitored.emplace(change.handle, *change.interval);
            }
        }
    }

    std::map<std::uint64_t, Duration> monitored;

private:
    server::ImageSource inner_;
};

/// An EURange that comes when the test says.
class LateRange final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override
    {
        const Uncounted in_test;
        for (server::ReadSlot& slot : batch.results()) {
            slot = DataValue{Variant{ExtensionObject::from(Range{0, 200})}};
        }
        kept.push_back(std::move(batch));
    }

    std::vector<server::ReadBatch> kept;
};

struct ImageParts {
    ImageParts()
    {
        server::ImageLayout layout;
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            REQUIRE(layout.add({BuiltInType::Int32, {}}));
        }
        image = server::ProcessImage::create(std::move(layout));
        image_source.emplace(image);
    }
    void scan(std::int32_t value)
    {
        image->begin_scan();
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            image->memory().value<std::int32_t>(i) = value;
        }
        image->publish(DateTime::from_unix_seconds(1'000 + value));
    }

    std::shared_ptr<server::ProcessImage> image;
    std::optional<ToldImageSource> image_source;
    LateRange range;
};

/// A Subscription with items of an image: by its scans, in intervals and with a filter in percent.
class ImageWorld : public ImageParts, public FailureFixture {
public:
    ImageWorld()
    {
        const std::uint32_t source = server.add_source(*image_source);
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            add(NodeId{1, i}, server.address_space().find(id::ObjectsFolder),
                QualifiedName{1, std::to_string(i).c_str()}, id::Int32, source, i);
        }
        add(own("range"), server.address_space().find(NodeId{1, 2}), QualifiedName{0, "EURange"},
            id::Range, server.add_source(range), 0);
        scan(1);
        CreateSubscriptionRequest request = subscription_request();
        request.requested_lifetime_count = 10'000;
        const auto made = client.call<CreateSubscriptionResponse>(request);
        REQUIRE(made);
        subscription = made->subscription_id;
    }

    [[nodiscard]] CreateMonitoredItemsRequest image_items() const
    {
        CreateMonitoredItemsRequest request;
        request.subscription_id = subscription;
        for (const auto& [variable, interval] :
             {std::pair{0U, 0.0}, {0U, 50.0}, {1U, 50.0}, {2U, 0.0}, {2U, 50.0}}) {
            MonitoredItemCreateRequest item;
            item.item_to_monitor = failing::value_of(NodeId{1, variable});
            item.monitoring_mode = MonitoringMode::Reporting;
            item.requested_parameters = parameters(request.items_to_create.size(), interval);
            request.items_to_create.push_back(item);
        }
        return request;
    }
    [[nodiscard]] static MonitoringParameters parameters(std::size_t handle, double interval)
    {
        MonitoringParameters parameters;
        parameters.client_handle = static_cast<std::uint32_t>(handle);
        parameters.sampling_interval = interval;
        parameters.queue_size = 5;
        if (handle >= 3) {
            DataChangeFilter filter;
            filter.trigger = DataChangeTrigger::StatusValue;
            filter.deadband_type = static_cast<std::uint32_t>(DeadbandType::Percent);
            filter.deadband_value = 5;
            parameters.filter = ExtensionObject::from(filter);
        }
        return parameters;
    }
    void make_items(MonitoringMode mode)
    {
        CreateMonitoredItemsRequest request = image_items();
        for (MonitoredItemCreateRequest& item : request.items_to_create) {
            item.monitoring_mode = mode;
        }
        const auto made = client.call<CreateMonitoredItemsResponse>(request);
        REQUIRE(made);
        REQUIRE(worst_of(*made) == status::Good);
        items.clear();
        for (const MonitoredItemCreateResult& result : made->results) {
            items.push_back(result.monitored_item_id);
        }
    }
    /// Which items report what a new scan has.
    [[nodiscard]] std::set<std::uint32_t> reporting()
    {
        constexpr std::int32_t next = 5'000;
        scan(next);
        std::set<std::uint32_t> found;
        for (const MonitoredItemNotification& one : reported()) {
            if (one.value.value == Variant{next}) {
                found.insert(one.client_handle);
            }
        }
        return found;
    }
    void complete_ranges()
    {
        for (server::ReadBatch& batch : std::exchange(range.kept, {})) {
            batch.complete();
        }
        server.handle_completions(now);
    }
    /// Of what the items were nothing is left.
    void check_counts()
    {
        DeleteSubscriptionsRequest request;
        request.subscription_ids = {subscription};
        CHECK(client.call<DeleteSubscriptionsResponse>(request));
        complete_ranges();
        for (int i = 0; i < 3; ++i) {
            pass(100ms, client);
        }
        scan(7'000); // has the server let go of the image
        pass(100ms, client);
        CHECK(server.monitored_item_count() == 0);
        const auto made = client.call<CreateSubscriptionResponse>(subscription_request());
        REQUIRE(made);
        subscription = made->subscription_id;
        CreateMonitoredItemsRequest more = image_items();
        more.items_to_create.resize(1);
        std::size_t count = 0;
        while (count <= most_items &&
               worst_of(client.call<CreateMonitoredItemsResponse>(more).value()).is_good()) {
            ++count;
        }
        CHECK(count == most_items);
        CHECK(image_source->monitored == std::map<std::uint64_t, Duration>{{0, Duration{0}}});
    }

    std::uint32_t subscription{0};
    std::vector<std::uint32_t> items;

private:
    void add(const NodeId& node_id, model::NodeIndex parent, const QualifiedName& name,
             std::uint32_t type, std::uint32_t source, std::uint64_t handle)
    {
        model::NewNode node;
        node.id = node_id;
        node.browse_name = name;
        node.parent = parent;
        model::NewVariable variable;
        variable.source = source;
        variable.handle = handle;
        variable.data_type = NodeId{0, type};
        if (type == id::Range) {
            node.reference_type = NodeId{0, id::HasProperty};
            variable.type_definition = NodeId{0, id::PropertyType};
        }
        REQUIRE(server.address_space().add_variable(node, variable));
    }
};

FailureCase create(ImageWorld& world)
{
    return asking<CreateMonitoredItemsResponse>(world.image_items());
}

FailureCase modify(ImageWorld& world)
{
    world.make_items(MonitoringMode::Reporting);
    ModifyMonitoredItemsRequest request;
    request.subscription_id = world.subscription;
    for (std::size_t i = 0; i < world.items.size(); ++i) {
        MonitoredItemModifyRequest change;
        change.monitored_item_id = world.items[i];
        change.requested_parameters = ImageWorld::parameters(i, i % 2 == 0 ? 100 : 0);
        change.requested_parameters.queue_size = 8;
        request.items_to_modify.push_back(change);
    }
    return asking<ModifyMonitoredItemsResponse>(request);
}

FailureCase set_mode(ImageWorld& world, MonitoringMode from, MonitoringMode to)
{
    world.make_items(from);
    SetMonitoringModeRequest request;
    request.subscription_id = world.subscription;
    request.monitoring_mode = to;
    request.monitored_item_ids = Array<std::uint32_t>{world.items};
    return asking<SetMonitoringModeResponse>(request);
}

FailureCase enable(ImageWorld& world)
{
    return set_mode(world, MonitoringMode::Disabled, MonitoringMode::Reporting);
}

FailureCase disable(ImageWorld& world)
{
    return set_mode(world, MonitoringMode::Reporting, MonitoringMode::Disabled);
}

struct Row {
    const char* service;
    FailureCase (*prepare)(ImageWorld&);
    bool has_items_after;
};

constexpr Row rows[] = {
    {"CreateMonitoredItems", create, true},
    {"ModifyMonitoredItems", modify, true},
    {"SetMonitoringMode to Reporting", enable, true},
    {"SetMonitoringMode to Disabled", disable, false},
};

/// False if nothing failed of the request.
bool fail_once(const Row& row, std::size_t k, std::size_t most)
{
    ImageWorld world;
    const FailureCase asked = row.prepare(world);
    auto [answer, has_failed] = world.attempt(asked, k, most);
    INFO(row.service << ", allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    world.scan(2); // has the server let go of an image without items
    world.pass(100ms, world.client);
    if (answer != status::Good) {
        answer = world.ask(world.client, asked);
    }
    CHECK(answer == status::Good);
    const std::set<std::uint32_t> all{0, 1, 2, 3, 4};
    CHECK(world.reporting() == (row.has_items_after ? all : std::set<std::uint32_t>{}));
    world.complete_ranges();
    world.check_counts();
    return has_failed;
}

} // namespace

TEST_CASE("items of an image that find no memory once do what they are asked to next time")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.service << ", " << most)
        {
            check_failing_worlds(row.service,
                                 [&](std::size_t k) { return fail_once(row, k, most); });
        }
    }
}

} // namespace image_item_failure_test
