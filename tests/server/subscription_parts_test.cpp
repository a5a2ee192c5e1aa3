#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/server/process_image.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/registry.hpp>

#include "server/session/session.hpp"
#include "server/subscription/sampler.hpp"
#include "server/subscription/subscription.hpp"
#include "server/subscription/subscription_services.hpp"
#include "server/subscription/subscription_table.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"

// Subscriptions without a server: the folder's own headers and what lies below them.

using namespace busbar;
using namespace busbar::server::detail;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Every Variable of namespace 0 has the value 1, until it is told otherwise.
struct FixedValues final : LiveValues {
    [[nodiscard]] Result<DataValue> find(const NodeId&, const ReadingUser&) const override
    {
        return DataValue{Variant{value}};
    }
    std::int32_t value{1};
};

struct NoEvents final : EventItems {
    [[nodiscard]] std::unique_ptr<MonitoredItem>
    make(const ItemContext&, const MonitoredItemCreateRequest&, ItemRevision& revision) override
    {
        revision.status = status::Bad_NotSupported;
        return nullptr;
    }
};

struct SubscriptionParts {
    explicit SubscriptionParts(std::size_t max_memory = server::SubscriptionLimits{}.max_memory)
        : limits{with_memory(max_memory)}
    {
        const auto made = all.create(session, {100ms, 30, 3, 0, 0}, true, TimePoint{});
        REQUIRE(made);
        subscription = *made;
    }
    ~SubscriptionParts() { all.session_ends(session, true); }
    SubscriptionParts(const SubscriptionParts&) = delete;
    SubscriptionParts& operator=(const SubscriptionParts&) = delete;

    void add_item(std::uint32_t client_handle)
    {
        add_item(client_handle, NodeId{0, id::Server_ServerStatus_State}, {});
    }
    void add_item(std::uint32_t client_handle, const NodeId& node, const String& range)
    {
        MonitoredItemCreateRequest request;
        request.item_to_monitor.node_id = node;
        request.item_to_monitor.index_range = range;
        request.item_to_monitor.attribute_id = 13;
        request.monitoring_mode = MonitoringMode::Reporting;
        request.requested_parameters.client_handle = client_handle;
        request.requested_parameters.sampling_interval = 50;
        ItemRevision revision;
        auto item = ValueItem::make({all, *subscription, TimePoint{}}, request,
                                    TimestampsToReturn::Neither, revision);
        REQUIRE(item);
        auto& added = subscription->add_item(std::move(item));
        all.sampler().add(static_cast<ValueItem&>(added), TimePoint{});
        all.sampler().sample_new(TimePoint{});
    }
    static server::ServerLimits with_memory(std::size_t most)
    {
        server::ServerLimits limits;
        limits.subscriptions.max_memory = most;
        limits.subscriptions.max_subscription_memory = most;
        return limits;
    }
    /// Takes all data notifications that are ready; how many there were.
    std::size_t take()
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        auto& ready = subscription->ready(MonitoredItem::Kind::Data);
        std::size_t count = 0;
        for (; !ready.empty(); ++count) {
            ready.take_notification(writer, 1'000);
        }
        return count;
    }

    FixedWallClock clock;
    SeededRandom random;
    LogBook log;
    server::ServerEnvironment environment{.random = &random, .wall_clock = &clock, .log = &log};
    server::ServerLimits limits;
    model::AddressSpace space;
    DataSources sources{nullptr};
    binary::TypeRegistry types{binary::namespace0_types()};
    Counters counters;
    FixedValues values;
    NoEvents events;
    SubscriptionNeeds needs{space,    sources, types, limits, environment,
                            counters, values,  log,   &events};
    SubscriptionTable all{needs};
    Session session{1'000'000, 1'000'000};
    Subscription* subscription{nullptr};
};

} // namespace

TEST_CASE("GetMonitoredItems and ResendData are there as functions")
{
    SubscriptionParts parts;
    Session other{1'000'000, 1'000'000};
    parts.add_item(7);
    parts.add_item(8);
    const std::uint32_t id = parts.subscription->id();

    const auto handles = get_monitored_items(parts.all, parts.session, id);
    REQUIRE(handles);
    CHECK(handles->server_handles == Array<std::uint32_t>{1, 2});
    CHECK(handles->client_handles == Array<std::uint32_t>{7, 8});
    CHECK(get_monitored_items(parts.all, parts.session, 0).error() ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(get_monitored_items(parts.all, other, id).error() == status::Bad_UserAccessDenied);

    CHECK(parts.take() == 2);
    CHECK(resend_data(parts.all, parts.session, id, {}) == status::Good);
    CHECK(parts.take() == 2);
    CHECK(resend_data(parts.all, other, id, {}) == status::Bad_UserAccessDenied);
    CHECK(resend_data(parts.all, parts.session, 0, {}) == status::Bad_SubscriptionIdInvalid);
}

TEST_CASE("items sample what changes, by the timers of their Subscriptions")
{
    SubscriptionParts parts;
    parts.add_item(7);
    CHECK(parts.take() == 1);
    const TimePoint due = parts.all.next_deadline();
    CHECK(due > TimePoint{});
    parts.all.handle_deadline(due);
    CHECK(parts.take() == 0); // the same value
    parts.values.value = 2;
    parts.all.handle_deadline(parts.all.next_deadline());
    CHECK(parts.take() == 1);
}

TEST_CASE("where nobody makes event items there are none")
{
    SubscriptionParts parts;
    MonitoredItemCreateRequest request;
    ItemRevision revision;
    CHECK(parts.needs.event_items->make({parts.all, *parts.subscription, {}}, request, revision) ==
          nullptr);
    CHECK(revision.status == status::Bad_NotSupported);
}

TEST_CASE("Subscriptions that lost their session live on until somebody deletes them")
{
    SubscriptionParts parts;
    parts.add_item(7);
    CHECK(parts.all.item_count() == 1);
    parts.all.session_ends(parts.session, false);
    parts.session.publishing.reset(); // as the session takes it along
    CHECK(parts.all.size() == 1);
    CHECK(parts.subscription->session() == nullptr);
    CHECK(parts.all.find(parts.subscription->id(), parts.session) == nullptr);
    parts.all.remove(*parts.subscription);
    CHECK(parts.all.size() == 0);
    CHECK(parts.all.item_count() == 0);
}

namespace {

/// An array of 1 MiB in a process image, which many items look at.
struct LargeArray {
    static constexpr std::uint32_t elements = 131'072;
    static constexpr std::size_t bytes = elements * sizeof(double);

    explicit LargeArray(std::size_t max_memory) : parts{max_memory}
    {
        model::NewNode node;
        REQUIRE(parts.space.add_namespace("urn:test").value() == 1);
        node.id = curve;
        node.browse_name = QualifiedName{1, "Curve"};
        node.parent = parts.space.find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Double};
        variable.value_rank = 1;
        variable.source = parts.sources.add(source);
        variable.handle = handle;
        REQUIRE(parts.space.add_variable(node, variable));
        scan(0, 0.5);
    }

    void scan(std::uint32_t element, double value)
    {
        image->begin_scan();
        const std::span<double> values = image->memory().values<double>(handle);
        std::fill(values.begin(), values.end(), 0);
        values[element] = value;
        image->publish(parts.clock.now());
    }

    NodeId curve{1, "Curve"};
    server::ImageLayout layout;
    std::uint32_t handle{layout.add({BuiltInType::Double, {elements}, 0}).value()};
    std::shared_ptr<server::ProcessImage> image{server::ProcessImage::create(std::move(layout))};
    server::ImageSource source{image};
    SubscriptionParts parts;
};

} // namespace

TEST_CASE("A2: all items of a variable share one copy of it, which is charged")
{
    constexpr std::size_t max_memory = 8U << 20U;
    LargeArray array{max_memory};
    const std::size_t before = array.parts.all.memory().left();
    array.parts.add_item(0, array.curve, "0");
    const std::size_t one = before - array.parts.all.memory().left();
    CHECK(one > LargeArray::bytes);
    CHECK(one < LargeArray::bytes + 4'096);
    for (std::uint32_t handle = 1; handle < 1'000; ++handle) {
        array.parts.add_item(handle, array.curve, "0");
    }
    CHECK(before - array.parts.all.memory().left() < LargeArray::bytes + 4'096 * 1'000);
    CHECK(array.parts.take() == 1'000);
    array.parts.all.session_ends(array.parts.session, true);
    while (array.parts.all.next_deadline() != no_deadline) {
        array.parts.all.handle_deadline(array.parts.all.next_deadline());
    }
    CHECK(array.parts.all.memory().left() == max_memory);
}

TEST_CASE("A2: a variable that nobody can pay a copy of is looked at each time")
{
    LargeArray array{512U << 10U};
    array.parts.add_item(1, array.curve, "7");
    array.parts.add_item(2, array.curve, "8");
    CHECK(array.parts.take() == 2);
    array.scan(7, 1.5);
    array.parts.all.handle_deadline(array.parts.all.next_deadline());
    CHECK(array.parts.take() == 1);
    array.scan(8, 1.5);
    array.parts.all.handle_deadline(array.parts.all.next_deadline());
    CHECK(array.parts.take() == 2);
}

TEST_CASE("an item that comes to a variable takes no change from the others")
{
    LargeArray array{8U << 20U};
    array.parts.add_item(1, array.curve, "7");
    CHECK(array.parts.take() == 1);
    array.scan(7, 1.5);
    array.parts.add_item(2, array.curve, "7"); // sees the new value before item 1 is sampled
    CHECK(array.parts.take() == 1);
    array.parts.all.handle_deadline(array.parts.all.next_deadline());
    CHECK(array.parts.take() == 1);
}
