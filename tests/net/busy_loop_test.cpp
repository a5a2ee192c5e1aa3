#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include <busbar/net/blocking_client.hpp>
#include <busbar/net/server_loop.hpp>
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
    explicit HeavySource(std::chrono::milliseconds duration) : duration_{duration} {}

    void read(server::ReadBatch batch) override
    {
        std::this_thread::sleep_for(batch.is_sample() ? duration_ : 0ms);
        for (auto& slot : batch.results()) {
            slot = DataValue{Variant{1}};
        }
        batch.complete();
    }

private:
    std::chrono::milliseconds duration_;
};

bool add_heavy(test::Station& station, HeavySource& source)
{
    return station.ask([&] {
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
}

/// Has items of one node that are sampled at different times.
void subscribe(net::BlockingClient& client, double publishing_interval)
{
    CreateSubscriptionRequest create;
    create.requested_publishing_interval = publishing_interval;
    create.requested_max_keep_alive_count = 1;
    create.publishing_enabled = true;
    const auto created = client.call<CreateSubscriptionResponse>(create);
    REQUIRE(created);
    CreateMonitoredItemsRequest items;
    items.subscription_id = created->subscription_id;
    for (int i = 0; i < 5; ++i) {
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
}

/// Gives a loop something to do each time that it does it, as a flood of connections would.
class Endless {
public:
    explicit Endless(net::ServerLoop& loop) : loop_{&loop} { again(); }
    Endless(const Endless&) = delete;
    Endless& operator=(const Endless&) = delete;
    ~Endless()
    {
        is_over_ = true;
        ended_.get_future().wait();
    }

private:
    void again()
    {
        loop_->post([this] {
            if (is_over_) {
                ended_.set_value();
            } else {
                again();
            }
        });
    }

    net::ServerLoop* loop_;
    std::atomic<bool> is_over_{false};
    std::promise<void> ended_;
};

} // namespace

TEST_CASE("clients are served although a deadline is always due", "[net]")
{
    HeavySource source{20ms};
    test::Station station;
    station.run();
    REQUIRE(add_heavy(station, source));
    test::ClientSurroundings surroundings;
    net::BlockingClient client{test::client_config(station.url()), surroundings.environment};
    REQUIRE(client.connect());
    subscribe(client, 1'000);
    for (int i = 0; i < 3; ++i) {
        CHECK(client.call<ReadResponse>(test::read_request(test::state_node)));
    }
}

TEST_CASE("Subscriptions publish although a deadline and something else are always due", "[net]")
{
    HeavySource source{20ms};
    test::Station station;
    station.run();
    REQUIRE(add_heavy(station, source));
    test::ClientSurroundings surroundings;
    net::BlockingClient client{test::client_config(station.url()), surroundings.environment};
    REQUIRE(client.connect());
    subscribe(client, 50);
    const Endless endless{station.loop};
    for (int i = 0; i < 3; ++i) {
        CHECK(client.call<PublishResponse>(PublishRequest{}));
    }
}

} // namespace busy_loop_test
