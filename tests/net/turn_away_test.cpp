#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>

#include <busbar/core/status_codes.hpp>

#include "channel/frame.hpp"
#include "net/turn_away.hpp"

namespace turn_away_test {

using namespace busbar;
using asio::ip::tcp;

namespace {

/// Two ends of a connection: ours, and that of the peer that there is no place for.
struct Visit {
    explicit Visit(asio::io_context& context)
    {
        tcp::acceptor acceptor{context, {asio::ip::address_v4::loopback(), 0}};
        peer.connect(acceptor.local_endpoint());
        ours = acceptor.accept();
    }
    /// What the peer reads until the end.
    [[nodiscard]] std::vector<std::byte> hear()
    {
        std::vector<std::byte> bytes(4'096);
        std::error_code end;
        bytes.resize(asio::read(peer, asio::buffer(bytes), end));
        return bytes;
    }
    /// What an Error message that it reads says; Good if there is none.
    [[nodiscard]] StatusCode hear_error()
    {
        const auto bytes = hear();
        if (bytes.size() < channel::detail::header_size) {
            return {};
        }
        const auto error =
            channel::detail::parse_error(std::span{bytes}.subspan(channel::detail::header_size));
        return error ? error->error : StatusCode{};
    }

    asio::io_context outside;
    tcp::socket peer{outside};
    tcp::socket ours{outside};
};

/// A door with one place, and nobody's turn before run().
struct Door {
    void turn_away(Visit& visit)
    {
        tcp::socket socket{context};
        socket.assign(tcp::v4(), visit.ours.release());
        away(std::move(socket), status::Bad_TcpServerTooBusy, "full");
    }
    void run()
    {
        context.restart();
        context.run();
    }

    asio::io_context context;
    net::detail::TurnAway away{1};
};

} // namespace

TEST_CASE("who comes while others are told that there is no place is closed without a word",
          "[net]")
{
    Door door;
    Visit first{door.context};
    Visit second{door.context};
    door.turn_away(first);
    door.turn_away(second);
    CHECK(second.hear().empty());
    door.context.poll();
    first.peer.shutdown(tcp::socket::shutdown_send);
    CHECK(first.hear_error() == status::Bad_TcpServerTooBusy);
    door.run();
    // There is a place again.
    Visit third{door.context};
    door.turn_away(third);
    door.context.restart();
    door.context.poll();
    third.peer.shutdown(tcp::socket::shutdown_send);
    CHECK(third.hear_error() == status::Bad_TcpServerTooBusy);
    door.run();
}

TEST_CASE("a peer that is turned away and goes on sending is not listened to for ever", "[net]")
{
    Door door;
    Visit talker{door.context};
    door.turn_away(talker);
    const std::vector<char> much(1'024);
    std::error_code error;
    talker.peer.non_blocking(true);
    for (int i = 0; i < 1'000 && !error; ++i) {
        talker.peer.write_some(asio::buffer(much), error);
        door.context.poll();
        error = error == asio::error::would_block ? std::error_code{} : error;
    }
    CHECK(error); // our end was closed
    door.run();
    Visit next{door.context};
    next.peer.shutdown(tcp::socket::shutdown_send);
    door.turn_away(next);
    door.run();
    CHECK(next.hear_error() == status::Bad_TcpServerTooBusy);
}

TEST_CASE("a peer that resets the connection cannot be told, and leaves its place", "[net]")
{
    Door door;
    Visit rude{door.context};
    rude.peer.set_option(asio::socket_base::linger{true, 0});
    rude.peer.close();
    door.turn_away(rude);
    door.run();
    Visit next{door.context};
    next.peer.shutdown(tcp::socket::shutdown_send);
    door.turn_away(next);
    door.run();
    CHECK(next.hear_error() == status::Bad_TcpServerTooBusy);
}

} // namespace turn_away_test
