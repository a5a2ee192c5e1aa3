#include <catch2/catch.hpp>

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
    [[nodiscard]] Result<DataValue> find(const NodeId&, const ValueReader&) const override
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
    SubscriptionParts()
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
        MonitoredItemCreateRequest request;
        request.item_to_monitor.node_id = NodeId{0, id::Server_ServerStatus_State};
        request.item_to_monitor.attribute_id = 13;
        request.monitoring_mode = MonitoringMode::Reporting;
        request.requested_parameters.client_handle = client_handle;
        request.requested_parameters.sampling_interval = 50;
        ItemRevision revision;
        auto item = DataItem::make({all, *subscription, TimePoint{}}, request,
                                   TimestampsToReturn::Neither, revision);
        REQUIRE(item);
        auto& added = subscription->add_item(std::move(item));
        all.sampler().add(static_cast<DataItem&>(added), TimePoint{});
        all.sampler().sample_new(TimePoint{});
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
    server::ServerEnvironment environment{&random, &clock, &log};
    server::ServerLimits limits;
    model::AddressSpace space;
    DataSources sources{nullptr};
    binary::TypeRegistry types{binary::namespace0_types()};
    Counters counters;
    FixedValues values;
    NoEvents events;
    SubscriptionNeeds needs{space, sources, types, limits, environment, counters, values, events};
    Subscriptions all{needs};
    Session session{1'000'000};
    Subscription* subscription{nullptr};
};

} // namespace

TEST_CASE("GetMonitoredItems and ResendData are there as functions")
{
    SubscriptionParts parts;
    Session other{1'000'000};
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
    CHECK(parts.needs.event_items.make({parts.all, *parts.subscription, {}}, request, revision) ==
          nullptr);
    CHECK(revision.status == status::Bad_NotSupported);
}

TEST_CASE("Subscriptions that lost their session live on until somebody deletes them")
{
    SubscriptionParts parts;
    parts.add_item(7);
    CHECK(parts.all.item_count() == 1);
    parts.all.session_ends(parts.session, false);
    CHECK(parts.all.size() == 1);
    CHECK(parts.subscription->session() == nullptr);
    CHECK(parts.all.find(parts.subscription->id(), parts.session) == nullptr);
    parts.all.remove(*parts.subscription);
    CHECK(parts.all.size() == 0);
    CHECK(parts.all.item_count() == 0);
}
