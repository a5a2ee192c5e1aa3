#include <catch2/catch.hpp>

#include <array>
#include <atomic>
#include <csignal>
#include <stdexcept>

#include <busbar/net/blocking_client.hpp>
#include <busbar/types/data_types.hpp>

#include "station.hpp"

namespace server_loop_test {

// What a loop is told while it runs, and how it ends.

using namespace busbar;
using namespace std::chrono_literals;
using asio::ip::tcp;
using busbar::test::BareClient;
using busbar::test::Station;

namespace {

class Guest : public test::ClientSurroundings {
public:
    explicit Guest(std::uint16_t port)
        : client{test::client_config("opc.tcp://127.0.0.1:" + std::to_string(port)), environment}
    {
        REQUIRE(client.connect());
    }
    /// ServerStatus.State; -1 if it cannot be read.
    [[nodiscard]] std::int32_t state()
    {
        const auto read = client.call<ReadResponse>(test::read_request(test::state_node));
        return read ? read->results[0].value.value_or(std::int32_t{-1}) : -1;
    }

    net::BlockingClient client;
};

constexpr auto running = static_cast<std::int32_t>(ServerState::Running);
constexpr auto going = static_cast<std::int32_t>(ServerState::Shutdown);

/// Whether somebody listens on the port.
bool is_open(std::uint16_t port)
{
    asio::io_context context;
    tcp::socket socket{context};
    std::error_code error;
    socket.connect({asio::ip::address_v4::loopback(), port}, error);
    return !error;
}

} // namespace

TEST_CASE("a port that is opened while the loop runs serves at once, and one that is closed nobody",
          "[net]")
{
    Station station;
    station.run();
    const auto second = station.ask([&] { return station.loop.listen("127.0.0.1", 0, 7); });
    REQUIRE(second);
    Guest guest{*second};
    CHECK(guest.state() == running);
    station.ask([&] {
        station.loop.stop_listening(*second);
        station.loop.stop_listening(*second); // which is none any more
        return true;
    });
    CHECK_FALSE(is_open(*second));
    CHECK(guest.state() == running);
    CHECK(Guest{station.port}.state() == running);
}

TEST_CASE("a loop that is told to stop twice goes once its clients have gone", "[net]")
{
    Station station;
    station.config.shutdown_delay = 1h;
    station.run();
    Guest guest{station.port};
    station.loop.stop();
    station.loop.stop();
    CHECK(guest.state() == going);
    CHECK_FALSE(is_open(station.port));
    const auto handed_over = station.ask(
        [&] { return station.loop.hand_over(station.server(), {.reason = "too late"}); });
    REQUIRE_FALSE(handed_over);
    CHECK(handed_over.error().where == "loop");
    CHECK(handed_over.error().status == status::Bad_InvalidState);
    guest.client.close();
    station.join();
    CHECK(station.server().is_stopped());
}

TEST_CASE("work that throws is logged, and the loop goes on", "[net]")
{
    Station station;
    station.run();
    station.loop.post([] { throw std::runtime_error{"a mistake"}; });
    CHECK(Guest{station.port}.state() == running);
    CHECK(station.log.contains("posted work threw: a mistake"));
}

TEST_CASE("a signal ends a loop, whatever the work before it throws", "[net]")
{
    Station station;
    int signal = SIGTERM;
    std::atomic<int> calls{0};
    SECTION("with work before")
    {
        station.loop.stop_on_signals([&] { ++calls; });
        station.run();
        REQUIRE(std::raise(signal) == 0);
        station.join();
        CHECK(calls == 1);
    }
    SECTION("with work that throws")
    {
        station.loop.stop_on_signals([] { throw std::runtime_error{"disk full"}; });
        station.run();
        REQUIRE(std::raise(signal) == 0);
        station.join();
        CHECK(station.log.contains("handler before a stop threw: disk full"));
    }
    SECTION("with none")
    {
        signal = SIGINT;
        station.loop.stop_on_signals();
        station.run();
        REQUIRE(std::raise(signal) == 0);
        station.join();
    }
    CHECK(station.server().is_stopped());
    CHECK_FALSE(is_open(station.port));
}

TEST_CASE("a client that is to be called has an URL, or nobody is", "[net][reverse]")
{
    Station station;
    net::ReverseConnectConfig config;
    config.client_urls = {"opc.tcp://127.0.0.1:1", "http://127.0.0.1"};
    const auto connected = station.loop.connect_to_clients(config);
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_TcpEndpointUrlInvalid);
}

TEST_CASE("a server without a place for a client that listens says nothing and calls again",
          "[net][reverse]")
{
    asio::io_context context;
    tcp::acceptor client{context, {asio::ip::address_v4::loopback(), 0}};
    Station station;
    station.config.limits.max_connections_per_address = 0;
    net::ReverseConnectConfig config;
    config.client_urls = {"opc.tcp://127.0.0.1:" + std::to_string(client.local_endpoint().port())};
    config.first_delay = 1ms;
    config.longest_delay = 2ms;
    REQUIRE(station.loop.connect_to_clients(config));
    station.run();
    for (int i = 0; i < 3; ++i) {
        tcp::socket socket = client.accept();
        std::array<char, 64> bytes{};
        std::error_code end;
        CHECK(socket.read_some(asio::buffer(bytes), end) == 0);
        CHECK(end == asio::error::eof);
    }
}

TEST_CASE("a loop that runs for a time does what is due and comes back", "[net]")
{
    Station station;
    station.config.shutdown_delay = 0ms;
    station.make();
    std::size_t posted = 0;
    for (int i = 0; i < 3; ++i) {
        station.loop.post([&] { ++posted; });
    }
    // Without time it does what is ready, however many that are.
    CHECK(station.loop.run_for(station.server(), 0ms));
    CHECK(posted == 3);
    CHECK(station.loop.run_for(station.server(), 0ms));

    std::atomic<bool> ends{false};
    std::thread thread{[&] {
        while (station.loop.run_for(station.server(), 1ms) && !ends) {
        }
    }};
    std::int32_t state = -1;
    {
        Guest guest{station.port};
        state = guest.state();
    }
    station.loop.stop();
    thread.join();
    CHECK(state == running);
    CHECK(station.server().is_stopped());
    CHECK_FALSE(station.loop.run_for(station.server(), 0ms));
    CHECK_FALSE(is_open(station.port));
}

TEST_CASE("a loop that runs for a time can be ended at once", "[net]")
{
    Station station;
    station.make();
    REQUIRE(station.loop.run_for(station.server(), 0ms));
    asio::io_context context;
    tcp::socket socket{context};
    socket.connect({asio::ip::address_v4::loopback(), station.port});
    for (int i = 0; i < 1'000 && station.server().connection_count() == 0; ++i) {
        REQUIRE(station.loop.run_for(station.server(), 1ms));
    }
    CHECK(station.server().connection_count() == 1);
    station.loop.end_at_once();
    CHECK(station.server().connection_count() == 0);
    CHECK_FALSE(station.loop.run_for(station.server(), 0ms));
    CHECK_FALSE(is_open(station.port));
}

} // namespace server_loop_test
