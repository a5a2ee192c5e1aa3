#include <catch2/catch.hpp>

#include <array>
#include <string>

#include <asio/error.hpp>

#include <busbar/net/blocking_client.hpp>

#include "station.hpp"

namespace link_test {

// What peers do to the connections of a server.

using namespace busbar;
using namespace std::chrono_literals;
using busbar::test::BareClient;
using busbar::test::Station;

namespace {

/// More than the sockets' buffers hold.
constexpr int many = 48;
constexpr int small_buffer = 4'096;

/// Somebody who is served whatever others do.
class Guest : public test::ClientSurroundings {
public:
    explicit Guest(const Station& station)
        : client_{test::client_config(station.url()), environment}
    {
        REQUIRE(client_.connect());
    }
    [[nodiscard]] bool is_served()
    {
        const auto read = client_.call<ReadResponse>(test::read_request(test::state_node));
        return read && read->results[0].value == Variant{std::int32_t{0}};
    }

private:
    net::BlockingClient client_;
};

} // namespace

TEST_CASE("a peer that asks and does not read holds nobody up, and finds it all when it reads",
          "[net]")
{
    Station station;
    station.run();
    BareClient lazy{station.port, small_buffer};
    lazy.open();
    lazy.ask(test::text_node, many);
    Guest guest{station};
    CHECK(guest.is_served());
    const Variant text{String{std::string(Station::text_size, 'x')}};
    for (int i = 0; i < many; ++i) {
        CHECK(lazy.answer() == text);
    }
    CHECK(guest.is_served());
}

TEST_CASE("a peer that resets the connection while it is sent to is gone, and nobody else", "[net]")
{
    Station station;
    station.run();
    Guest guest{station};
    {
        BareClient rude{station.port, small_buffer};
        rude.open();
        rude.ask(test::text_node, many);
        CHECK(guest.is_served());
        rude.reset();
    }
    station.await_connections(1);
    CHECK(guest.is_served());
}

TEST_CASE("a peer that takes none of its answers for long loses its connection", "[net]")
{
    Station station;
    station.config.limits.send_timeout = 50ms;
    station.run();
    BareClient lazy{station.port, small_buffer};
    lazy.open();
    lazy.ask(test::text_node, many);
    station.await_connections(0);
    CHECK(station.log.contains("the peer took none of its answers"));
    CHECK(lazy.end()); // an end there is, be it a reset
}

TEST_CASE("a peer that closes its half gets what it asked for, and then the end", "[net]")
{
    Station station;
    station.run();
    BareClient brief{station.port};
    brief.open();
    brief.ask(test::state_node);
    brief.socket.shutdown(asio::ip::tcp::socket::shutdown_send);
    CHECK(brief.answer() == Variant{std::int32_t{0}});
    CHECK(brief.end() == asio::error::eof);
    station.await_connections(0);
}

TEST_CASE("a peer that says nothing is told so after its time", "[net]")
{
    Station station;
    station.config.limits.sessionless_timeout = 20ms;
    station.run();
    BareClient silent{station.port};
    CHECK(silent.end() == asio::error::eof);
    station.await_connections(0);
    CHECK(station.log.contains("no activated session within"));
}

TEST_CASE("a peer that is gone before it is accepted takes no place", "[net]")
{
    Station station;
    BareClient{station.port}.reset();
    BareClient second{station.port};
    station.run();
    second.open();
    CHECK(station.ask([&] { return station.server().connection_count(); }) == 1);
    CHECK_FALSE(station.log.contains("no place"));
}

} // namespace link_test
