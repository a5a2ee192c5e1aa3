#include <catch2/catch.hpp>

#include <chrono>
#include <thread>

#include <busbar/net/blocking_client.hpp>
#include <busbar/types/subscription.hpp>

#include "station.hpp"

namespace busy_loop_test {

// A loop whose deadlines take longer than the time between them.

using namespace busbar;
using namespace std::chrono_literals;

namespace {

/// Takes longer for a sample than its interval lasts.
class HeavySource final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override
    {
        std::this_thread::sleep_for(batch.is_sample() ? 20ms : 0ms);
        for (auto& slot : batch.results()) {
            slot = DataValue{Variant{1}};
        }
        batch.complete();
    }
};

} // namespace

TEST_CASE("clients are served although a deadline is always due", "[net]")
{
    HeavySource source;
    test::Station station;
    station.run();
    station.ask([&] {
        model::NewVariable variable;
        variable.source = station.server().add_source(source);
        variable.data_type = NodeId{0, id::Int32};
        model::NewNode node;
        node.id = NodeId{1, "Heavy"};
        node.browse_name = QualifiedName{1, "Heavy"};
        model::AddressSpace& space = station.server().address_space();
        node.parent = space.find(id::ObjectsFolder);
        return space.add_variable(node, variable).has_value();
    });
    test::ClientSurroundings surroundings;
    net::BlockingClient client{test::client_config(station.url()), surroundings.environment};
    REQUIRE(client.connect());
    CreateSubscriptionRequest create;
    create.requested_publishing_interval = 1'000;
    create.publishing_enabled = true;
    const auto created = client.call<CreateSubscriptionResponse>(create);
    REQUIRE(created);
    CreateMonitoredItemsRequest items;
    items.subscription_id = created->subscription_id;
    for (int i = 0; i < 5; ++i) { // sampled at different times
        MonitoredItemCreateRequest& item = items.items_to_create.emplace_back();
        item.item_to_monitor.node_id = NodeId{1, "Heavy"};
        item.item_to_monitor.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.sampling_interval = 10 + i;
    }
    const auto made = client.call<CreateMonitoredItemsResponse>(items);
    REQUIRE(made);
    REQUIRE(made->results[0].status_code.is_good());
    CHECK(made->results[0].revised_sampling_interval <= 10);
    for (int i = 0; i < 3; ++i) {
        CHECK(client.call<ReadResponse>(test::read_request(test::state_node)));
    }
}

} // namespace busy_loop_test
