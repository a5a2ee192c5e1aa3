#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <catch2/catch.hpp>

#include <busbar/server/process_image.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/registry.hpp>

#include "server/session/session.hpp"
#include "server/subscription/sampler.hpp"
#include "server/subscription/subscription.hpp"
#include "server/subscription/subscription_table.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"

/// Subscriptions without a server: the folder's own headers and what lies below them.
namespace busbar::test {

/// Every Variable of namespace 0 has the value 1, until it is told otherwise.
struct FixedValues final : server::detail::LiveValues {
    [[nodiscard]] Result<DataValue> find(const NodeId&,
                                         const server::detail::ReadingUser&) const override
    {
        return DataValue{Variant{value}};
    }
    std::int32_t value{1};
};

struct NoEvents final : server::detail::EventItems {
    [[nodiscard]] std::unique_ptr<server::detail::MonitoredItem>
    make(const server::detail::ItemContext&, const MonitoredItemCreateRequest&,
         server::detail::ItemRevision& revision) override
    {
        revision.status = status::Bad_NotSupported;
        return nullptr;
    }
};

struct BareSubscription {
    explicit BareSubscription(std::size_t max_memory = server::SubscriptionLimits{}.max_memory)
        : limits{with_memory(max_memory)}
    {
        const auto made =
            all.create(session, {std::chrono::milliseconds{100}, 30, 3, 0, 0}, true, TimePoint{});
        REQUIRE(made);
        subscription = *made;
    }
    ~BareSubscription() { all.session_ends(session, true); }
    BareSubscription(const BareSubscription&) = delete;
    BareSubscription& operator=(const BareSubscription&) = delete;

    void add_item(std::uint32_t client_handle)
    {
        add_item(client_handle, NodeId{0, id::Server_ServerStatus_State}, {});
    }
    server::detail::ValueItem* add_item(std::uint32_t client_handle, const NodeId& node,
                                        const String& range)
    {
        server::detail::ValueItem* const added = add_new_item(client_handle, node, range, 50);
        all.sampler().sample_new(TimePoint{});
        return added;
    }
    /// It has no sample yet.
    server::detail::ValueItem* add_new_item(std::uint32_t client_handle, const NodeId& node,
                                            const String& range, double interval)
    {
        MonitoredItemCreateRequest request;
        request.item_to_monitor.node_id = node;
        request.item_to_monitor.index_range = range;
        request.item_to_monitor.attribute_id = 13;
        request.monitoring_mode = MonitoringMode::Reporting;
        request.requested_parameters.client_handle = client_handle;
        request.requested_parameters.sampling_interval = interval;
        server::detail::ItemRevision revision;
        auto item = server::detail::ValueItem::make({all, *subscription, TimePoint{}}, request,
                                                    TimestampsToReturn::Neither, revision);
        REQUIRE(item);
        auto& added =
            static_cast<server::detail::ValueItem&>(subscription->add_item(std::move(item)));
        all.sampler().add(added, TimePoint{});
        return &added;
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
        auto& ready = subscription->ready(server::detail::MonitoredItem::Kind::Data);
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
    server::detail::DataSources sources{nullptr};
    binary::TypeRegistry types{binary::namespace0_types()};
    server::detail::Counters counters;
    FixedValues values;
    NoEvents events;
    server::detail::SubscriptionNeeds needs{space,    sources, types, limits, environment,
                                            counters, values,  log,   &events};
    server::detail::SubscriptionTable all{needs};
    server::detail::Session session{1'000'000, 1'000'000};
    server::detail::Subscription* subscription{nullptr};
};

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
        variable.source = parts.sources.add(*source);
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
    std::optional<server::ImageSource> source{image};
    BareSubscription parts;
};

} // namespace busbar::test
