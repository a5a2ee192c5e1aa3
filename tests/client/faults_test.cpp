#include <catch2/catch.hpp>

#include <stdexcept>

#include <busbar/client/attributes.hpp>
#include <busbar/types/ids.hpp>

#include "client_fixture.hpp"

namespace faults_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

[[noreturn]] void break_down()
{
    throw std::runtime_error{"bus error"};
}

const NodeId server_time{0, id::Server_ServerStatus_CurrentTime};

struct Plant : ClientFixture {
    Plant() : ClientFixture{ClientFixture::insecure()} {}

    [[nodiscard]] bool has_told(std::string_view callback) const
    {
        return log.text.find(std::string{callback} + " threw: bus error") != std::string::npos;
    }
    /// One item of the server's time, and one of its events.
    client::SubscriptionHandle watch(client::SubscriptionHandlers handlers)
    {
        client::SubscriptionSettings settings;
        settings.publishing_interval = 100ms;
        auto& subscriptions = client.subscriptions();
        const auto made = subscriptions.create(settings, std::move(handlers)).value();
        client::ItemSettings time;
        time.node = server_time;
        time.sampling_interval = 100ms;
        REQUIRE(subscriptions.add_items(made, {time}));
        return made;
    }
};

} // namespace

TEST_CASE("what handlers of requests and states throw is logged, and the next are called")
{
    Plant plant;
    plant.also_on_state = [](client::ClientState) { break_down(); };
    plant.connect();
    CHECK(plant.is_ready());
    CHECK(plant.has_told("Client::on_state handler"));
    plant.client.call<ReadResponse>(ReadRequest{},
                                    [](const Result<ReadResponse>&) { break_down(); });
    plant.read();
    plant.run();
    CHECK(plant.answers == std::vector<StatusCode>{status::Good});
    CHECK(plant.has_told("response handler"));

    plant.log.text.clear();
    client::read(plant.client, {client::attribute_of(server_time)},
                 [](const std::vector<DataValue>&) { break_down(); });
    plant.read();
    plant.run();
    CHECK(plant.answers.size() == 2);
    CHECK(plant.has_told("response handler"));
}

TEST_CASE("what handlers of a Subscription throw is logged, and it goes on")
{
    Plant plant;
    int changes = 0;
    client::SubscriptionHandlers handlers;
    handlers.on_data = [&](std::span<const client::DataChange>) {
        ++changes;
        break_down();
    };
    handlers.on_item = [](client::ItemHandle, const client::ItemStatus&) { break_down(); };
    handlers.on_gap = [](const client::Gap&) { break_down(); };
    handlers.on_status = [](StatusCode, client::DeliveryMode, const CreateSubscriptionResponse&) {
        break_down();
    };
    plant.connect();
    plant.watch(std::move(handlers));
    plant.advance(3s);
    const int before = changes;
    CHECK(before > 20);
    plant.restart(plant.server_config);
    plant.advance(10s);
    CHECK(plant.is_ready());
    CHECK(changes > before + 20);
    for (const char* handler : {"on_data", "on_item", "on_gap", "on_status"}) {
        CAPTURE(handler);
        CHECK(plant.has_told("SubscriptionHandlers::" + std::string{handler}));
    }
}

TEST_CASE("a client goes on though its log throws")
{
    Plant plant;
    plant.log.is_broken = true;
    plant.connect();
    plant.client.call<ReadResponse>(ReadRequest{},
                                    [](const Result<ReadResponse>&) { break_down(); });
    plant.cut();
    plant.advance(10s);
    CHECK(plant.is_ready());
    plant.log.is_broken = false;
}

} // namespace faults_test
