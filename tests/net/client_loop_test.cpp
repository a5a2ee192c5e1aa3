#include <catch2/catch.hpp>

#include <string>
#include <thread>

#include <busbar/net/client_loop.hpp>

#include "full_port.hpp"
#include "station.hpp"

namespace client_loop_test {

// What a ClientLoop says of servers that are not there, or not any more.

using namespace busbar;
using namespace std::chrono_literals;
using asio::ip::tcp;
using Kind = client::ConnectionEvent::Kind;

namespace {

struct Caller : test::ClientSurroundings {
    [[nodiscard]] Result<void> connect(const std::string& url, Duration timeout = 10s)
    {
        client::ConnectionConfig config;
        config.channel.endpoint_url = url;
        return loop.connect(std::move(config), environment, timeout);
    }
    [[nodiscard]] StatusCode error_of(const std::string& url, Duration timeout = 10s)
    {
        const auto connected = connect(url, timeout);
        return connected ? StatusCode{} : connected.error();
    }

    net::ClientLoop loop;
};

/// Takes one connection, and does with it what the test says.
struct Taker {
    asio::io_context context;
    tcp::acceptor acceptor{context, {asio::ip::address_v4::loopback(), 0}};

    [[nodiscard]] std::string url() const
    {
        return "opc.tcp://127.0.0.1:" + std::to_string(acceptor.local_endpoint().port());
    }
    /// Its system takes connections before we do.
    [[nodiscard]] tcp::socket take() { return acceptor.accept(); }
};

} // namespace

TEST_CASE("a loop says why there is no connection", "[net][client]")
{
    Caller caller;
    CHECK(caller.error_of("http://127.0.0.1") == status::Bad_TcpEndpointUrlInvalid);
    CHECK(caller.error_of("opc.tcp://" + std::string(64, 'x') + ".example") ==
          status::Bad_CommunicationError);
    const test::FullPort full{"127.0.0.1", 0};
    CHECK(caller.error_of("opc.tcp://127.0.0.1:" + std::to_string(full.port), 20ms) ==
          status::Bad_Timeout);
    caller.loop.close(); // nothing
    // And then there is one.
    test::Station station;
    station.run();
    REQUIRE(caller.connect(station.url()));
    CHECK(caller.loop.wait_until_ready());
    caller.loop.close();
    caller.loop.close();
    station.await_connections(0);
}

TEST_CASE("a loop waits no longer than it is told to", "[net][client]")
{
    Taker silent;
    Caller caller;
    REQUIRE(caller.connect(silent.url()));
    CHECK_FALSE(caller.loop.wait(5ms));
    CHECK_FALSE(caller.loop.wait(Duration{}));
}

TEST_CASE("a loop tells of a server that ends the connection", "[net][client]")
{
    Taker taker;
    Caller caller;
    REQUIRE(caller.connect(taker.url()));
    tcp::socket ours = taker.take();
    SECTION("with a reset")
    {
        ours.set_option(asio::socket_base::linger{true, 0});
        ours.close();
    }
    SECTION("with an end")
    {
        ours.shutdown(tcp::socket::shutdown_send);
    }
    const auto ready = caller.loop.wait_until_ready();
    REQUIRE_FALSE(ready);
    CHECK(ready.error() == status::Bad_ConnectionClosed);
    const auto again = caller.loop.wait();
    REQUIRE(again);
    CHECK(again->kind == Kind::Closed);
    CHECK(again->status == status::Bad_ConnectionClosed);
    CHECK_FALSE(caller.loop.call(test::read_request(test::state_node)));
    caller.loop.close();
}

TEST_CASE("a loop tells what becomes of a request whose server goes", "[net][client]")
{
    test::Station station;
    station.run();
    Caller caller;
    REQUIRE(caller.connect(station.url()));
    REQUIRE(caller.loop.wait_until_ready());
    station.stop();
    const auto read = caller.loop.call(test::read_request(test::state_node));
    REQUIRE(read);
    CHECK(read->kind == Kind::Response);
    CHECK(read->status == status::Bad_SecureChannelClosed);
    CHECK(read->body.empty());
    const auto closed = caller.loop.wait();
    REQUIRE(closed);
    CHECK(closed->kind == Kind::Closed);
}

} // namespace client_loop_test
