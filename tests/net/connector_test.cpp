#include <catch2/catch.hpp>

#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>

#include <busbar/harness/log_book.hpp>

#include "full_port.hpp"
#include "net/connector.hpp"

namespace connector_test {

using namespace busbar;
using namespace std::chrono_literals;
using asio::ip::tcp;

namespace {

using Addresses = std::vector<asio::ip::address>;
using Connected = Expected<tcp::socket, net::detail::Unreached>;

asio::ip::address address(const char* text)
{
    return asio::ip::make_address(text);
}

/// Connects to a host that has the addresses that it is given.
struct Dialer {
    explicit Dialer(Addresses addresses)
        : connector{context.get_executor(), log,
                    [all = std::move(addresses)](const std::string&) { return all; }}
    {
    }
    void start(std::uint16_t port, Duration timeout = 1h)
    {
        auto url = channel::EndpointUrl::parse("opc.tcp://plc.example:" + std::to_string(port));
        REQUIRE(url);
        connector.start(*url, timeout, [this](Connected socket) {
            ++calls;
            if (socket) {
                connected.emplace(*std::move(socket));
            } else {
                error = socket.error().status;
            }
        });
    }
    void run()
    {
        while (calls == 0) {
            context.restart(); // the name is looked up elsewhere
            context.run_one();
        }
    }

    harness::LogBook log;
    asio::io_context context;
    net::detail::Connector connector;
    int calls{0};
    std::optional<tcp::socket> connected;
    StatusCode error;
};

/// Somebody who listens at 127.0.0.1.
struct Open {
    asio::io_context context;
    tcp::acceptor acceptor{context, {asio::ip::address_v4::loopback(), 0}};
    std::uint16_t port{acceptor.local_endpoint().port()};
};

} // namespace

TEST_CASE("a host that refuses at one address is reached at the next", "[net][client]")
{
    const Open open;
    Dialer dialer{{address("127.0.0.2"), address("127.0.0.3"), address("127.0.0.1")}};
    dialer.start(open.port);
    dialer.run();
    REQUIRE(dialer.connected);
    CHECK(dialer.connected->remote_endpoint().address() == address("127.0.0.1"));
    CHECK(dialer.log.text().empty());
}

TEST_CASE("a host that does not answer at one address is reached at the next", "[net][client]")
{
    const Open open;
    const test::FullPort full{"127.0.0.2", open.port};
    Dialer dialer{{address("127.0.0.2"), address("127.0.0.1")}};
    dialer.start(open.port);
    dialer.run();
    REQUIRE(dialer.connected);
    CHECK(dialer.connected->remote_endpoint().address() == address("127.0.0.1"));
    dialer.context.restart();
    dialer.context.run(); // the other attempt is given up
    CHECK(dialer.calls == 1);
}

TEST_CASE("a host that does not answer anywhere is given up in time", "[net][client]")
{
    const test::FullPort full{"127.0.0.2", 0};
    Dialer dialer{{address("127.0.0.2")}};
    dialer.start(full.port, 20ms);
    dialer.run();
    CHECK(dialer.error == status::Bad_Timeout);
    CHECK(dialer.log.contains("cannot connect to opc.tcp://plc.example:" +
                              std::to_string(full.port) + ": no answer in time"));
}

TEST_CASE("the log says why a host is not reached", "[net][client]")
{
    const Open open;
    SECTION("it refuses everywhere")
    {
        Dialer dialer{{address("127.0.0.2"), address("127.0.0.3")}};
        dialer.start(open.port);
        dialer.run();
        CHECK(dialer.error == status::Bad_CommunicationError);
        CHECK(dialer.log.contains(": Connection refused"));
    }
    SECTION("it is nowhere")
    {
        Dialer dialer{{}};
        dialer.start(open.port);
        dialer.run();
        CHECK(dialer.error == status::Bad_CommunicationError);
        CHECK(dialer.log.contains(": the host has no address"));
    }
    SECTION("it is everywhere, more than is tried")
    {
        Addresses addresses(16, address("127.0.0.2"));
        addresses.push_back(address("127.0.0.1"));
        Dialer dialer{addresses};
        dialer.start(open.port, no_deadline - TimePoint{});
        dialer.run();
        CHECK(dialer.error == status::Bad_CommunicationError);
        CHECK(dialer.log.contains(": Connection refused"));
    }
}

TEST_CASE("of two attempts only the later one is heard of", "[net][client]")
{
    const Open open;
    const test::FullPort full{"127.0.0.1", 0};
    Dialer dialer{{address("127.0.0.1")}};
    const auto to_full =
        channel::EndpointUrl::parse("opc.tcp://127.0.0.1:" + std::to_string(full.port));
    bool is_called = false;
    dialer.connector.start(*to_full, 1h, [&](const Connected&) { is_called = true; });
    for (int i = 0; i < 2; ++i) { // its address is found, and its socket waits
        dialer.context.restart();
        dialer.context.run_one_for(20ms);
    }
    dialer.start(open.port);
    dialer.run();
    CHECK(dialer.connected);
    dialer.context.restart();
    dialer.context.run();
    CHECK_FALSE(is_called);
}

TEST_CASE("an attempt that is cancelled is not heard of", "[net][client]")
{
    Open open;
    Dialer dialer{{address("127.0.0.1")}};
    const auto url =
        channel::EndpointUrl::parse("opc.tcp://127.0.0.1:" + std::to_string(open.port));
    dialer.connector.start(*url, 1h, [&](const Connected&) { ++dialer.calls; });
    dialer.context.run_one(); // the socket connects
    tcp::socket peer = open.acceptor.accept();
    dialer.connector.cancel(); // although it is connected already
    dialer.context.restart();
    dialer.context.run();
    CHECK(dialer.calls == 0);
    std::array<char, 1> byte{};
    std::error_code end;
    peer.read_some(asio::buffer(byte), end);
    CHECK(end);
}

} // namespace connector_test
