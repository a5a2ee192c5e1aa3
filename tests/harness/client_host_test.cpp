#include <catch2/catch.hpp>

#include <memory>
#include <optional>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/client_host.hpp>
#include <busbar/types/discovery.hpp>

namespace client_host_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

ReadRequest read_state()
{
    ReadRequest request;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = NodeId{0, 2259U}; // Server_ServerStatus_State
    item.attribute_id = 13;
    return request;
}

} // namespace

TEST_CASE("a Client gets its connections from the world", "[harness]")
{
    World world;
    ServerHost server{world};
    ClientHost host{world};
    CHECK_THAT(host.connect(), succeeds<void>());
    CHECK(host.state() == client::ClientState::Ready);
    const auto response = host.call<ReadResponse>(read_state());
    REQUIRE(response);
    CHECK_THAT(response->results[0], holds(0));
    host.close();
    CHECK(host.state() == client::ClientState::Closed);
    world.run_for(1s);
    CHECK(server.server().session_count() == 0);
    CHECK(server.server().connection_count() == 0);
}

TEST_CASE("a Client comes back over a new link", "[harness]")
{
    World world;
    ServerHost server{world};
    ClientHost host{world};
    REQUIRE(host.connect());
    const std::size_t before = world.network().connection_count();
    world.network().play({fault::cut(), fault::refuse().times(2)});
    CHECK(world.run_until([&] { return host.state() != client::ClientState::Ready; }, 1s));
    CHECK(world.run_until([&] { return host.state() == client::ClientState::Ready; }, 1min));
    CHECK(world.network().connection_count() >= before + 3);
    CHECK(host.call<ReadResponse>(read_state()).has_value());
    CHECK(server.server().session_count() == 1);
    CHECK(world.network().pending_faults() == "");
}

TEST_CASE("a Client says why it is not connected", "[harness]")
{
    World world;
    ClientHost host{world};
    const auto connected = host.connect(1min);
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_ConnectionRejected);
    ServerHost server{world};
    CHECK(world.run_until([&] { return host.state() == client::ClientState::Ready; }, 2min));
}

TEST_CASE("a Client finds a server that was started anew", "[harness]")
{
    World world;
    auto server = std::make_unique<ServerHost>(world);
    ClientHost host{world};
    REQUIRE(host.connect());
    server.reset();
    CHECK(world.run_until([&] { return host.state() != client::ClientState::Ready; }, 1min));
    world.run_for(10s);
    server = std::make_unique<ServerHost>(world);
    CHECK(world.run_until([&] { return host.state() == client::ClientState::Ready; }, 2min));
    CHECK(server->server().session_count() == 1);
}

TEST_CASE("a Client that a handler closed is told that it is refused now", "[harness]")
{
    World world;
    auto server = std::make_unique<ServerHost>(world);
    client::ClientConfig config = open_client_config();
    config.wants_session = false;
    config.reconnect.is_enabled = false;
    ClientHost host{world, config};
    REQUIRE(host.connect());
    host.client().call<GetEndpointsResponse>(
        GetEndpointsRequest{},
        [&](const Result<GetEndpointsResponse>&) { host.client().close(world.now()); });
    const auto is_closed = [&] { return host.state() == client::ClientState::Closed; };
    REQUIRE(world.run_until(is_closed, 1s));
    server.reset();
    const auto connected = host.connect(1min);
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_ConnectionRejected);
}

TEST_CASE("a connection that is not there answers at once", "[harness]")
{
    World world;
    ServerHost server{world};
    ConnectionHost host{world};
    CHECK(host.call<ReadResponse>(read_state()).error() == status::Bad_NotConnected);
    world.network().play(fault::hold());
    CHECK(host.open(1s).error() == status::Bad_Timeout);
    host.drop();
    CHECK_FALSE(host.is_ready());
    CHECK(host.call<ReadResponse>(read_state()).error() == status::Bad_NotConnected);
    REQUIRE(host.open());
    CHECK(host.call<ReadResponse>(read_state()).has_value());
    // What is under way when the connection goes is answered, too.
    std::optional<StatusCode> answer;
    host.send<ReadResponse>(read_state(), [&](Result<ReadResponse> response) {
        answer = response ? StatusCode{} : response.error();
    });
    host.drop();
    CHECK(answer == StatusCode{status::Bad_ConnectionClosed});
    CHECK(host.closed_by() == status::Bad_ConnectionClosed);
    host.close();
    host.drop();
    CHECK(host.open().has_value());
}

} // namespace client_host_test
