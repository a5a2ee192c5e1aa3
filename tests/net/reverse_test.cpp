#include <catch2/catch.hpp>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>

#include <busbar/net/async_client.hpp>
#include <busbar/net/blocking_client.hpp>

#include "channel/frame.hpp"
#include "channel/output_buffer.hpp"
#include "machine.hpp"
#include "net/reverse_queue.hpp"
#include "support/identity.hpp"

namespace reverse_test {

using namespace busbar;
using namespace std::chrono_literals;
using asio::ip::tcp;
using busbar::test::Machine;
using client::ClientState;

namespace {

net::ReverseConnectConfig to_client_at(std::uint16_t port)
{
    net::ReverseConnectConfig config;
    config.client_urls = {"opc.tcp://127.0.0.1:" + std::to_string(port)};
    config.first_delay = 5ms;
    config.longest_delay = 20ms;
    return config;
}

client::ClientConfig reverse_config(const std::string& server_uri = test::machine_uri)
{
    auto config = test::client_config("");
    config.is_reverse = true;
    config.server_uri = server_uri;
    return config;
}

/// A port that was free a moment ago.
std::uint16_t free_port()
{
    asio::io_context context;
    const tcp::acceptor acceptor{context, {asio::ip::make_address("127.0.0.1"), 0}};
    return acceptor.local_endpoint().port();
}

/// A listener on its own, with a client that expects the machine but wants no connection.
struct Door : test::ClientSurroundings {
    explicit Door(const net::ReverseListenerLimits& limits = {})
        : listener{context.get_executor(), log, limits}, port{*listener.listen("127.0.0.1", 0)}
    {
        client.take_from(listener);
    }

    asio::io_context context;
    net::ReverseListener listener;
    std::uint16_t port;
    net::AsyncClient client{context.get_executor(), reverse_config(), environment};
};

/// Somebody who knocks.
class Stranger {
public:
    explicit Stranger(Door& door) : door_{&door}
    {
        socket_.connect({asio::ip::make_address("127.0.0.1"), door.port});
    }
    void say(std::span<const std::byte> bytes)
    {
        asio::write(socket_, asio::buffer(bytes.data(), bytes.size()));
    }
    void say_hello(std::string_view uri, std::string_view url)
    {
        channel::detail::OutputBuffer output;
        write_reverse_hello(output, uri, url);
        say(output.output());
    }
    /// What it hears until it is shown the door.
    [[nodiscard]] std::vector<std::byte> hear()
    {
        std::vector<std::byte> heard;
        std::array<std::byte, 256> bytes;
        bool is_over = false;
        const std::function<void()> read = [&] {
            socket_.async_read_some(asio::buffer(bytes), [&](std::error_code error, std::size_t n) {
                heard.insert(heard.end(), bytes.begin(), bytes.begin() + static_cast<long>(n));
                is_over = bool{error};
                if (!error) {
                    read();
                }
            });
        };
        read();
        while (!is_over) {
            REQUIRE(door_->context.run_one() != 0);
        }
        return heard;
    }
    [[nodiscard]] std::optional<StatusCode> refusal()
    {
        const auto bytes = hear();
        if (bytes.size() < channel::detail::header_size) {
            return std::nullopt;
        }
        const auto error =
            channel::detail::parse_error(std::span{bytes}.subspan(channel::detail::header_size));
        return error ? std::optional{error->error} : std::nullopt;
    }

    [[nodiscard]] bool has_news() const { return socket_.available() != 0; }

private:
    Door* door_;
    tcp::socket socket_{door_->context};
};

} // namespace

TEST_CASE("a server connects to a client that waits for it",
          "[net][reverse][unit:Protocol Reverse Connect Server]")
{
    test::ClientSurroundings around;
    net::BlockingClient client{reverse_config(), around.environment};
    const auto port = client.listen("127.0.0.1", 0);
    REQUIRE(port);
    auto machine = std::make_unique<Machine>(std::uint16_t{0}, to_client_at(*port));
    REQUIRE(client.connect());
    const auto read = client.call<ReadResponse>(test::read_request(test::state_node));
    REQUIRE(read);
    CHECK(read->results[0].value == Variant{std::int32_t{0}});
    // The server goes and comes back.
    machine.reset();
    REQUIRE(client.run_until([&] { return client.client().state() != ClientState::Ready; }));
    machine = std::make_unique<Machine>(std::uint16_t{0}, to_client_at(*port));
    CHECK(client.call<ReadResponse>(test::read_request(test::state_node)));
    client.close();
}

TEST_CASE("a server goes on trying until its client is there", "[net][reverse]")
{
    const std::uint16_t port = free_port();
    Machine machine{0, to_client_at(port)};
    test::ClientSurroundings around;
    net::BlockingClient client{reverse_config(), around.environment};
    REQUIRE(client.listen("127.0.0.1", port));
    CHECK(client.connect());
}

TEST_CASE("a server has a connection for every client that needs one", "[net][reverse]")
{
    test::ClientSurroundings around;
    asio::io_context context;
    net::ReverseListener listener{context.get_executor(), around.log};
    Machine machine{0, to_client_at(*listener.listen("127.0.0.1", 0))};
    std::vector<std::unique_ptr<net::AsyncClient>> clients;
    int ready = 0;
    for (int i = 0; i < 3; ++i) {
        clients.push_back(std::make_unique<net::AsyncClient>(context.get_executor(),
                                                             reverse_config(), around.environment));
        clients.back()->take_from(listener);
        clients.back()->connect(10s, [&](const Result<void>& connected) {
            CHECK(connected);
            ++ready;
        });
    }
    while (ready < 3) {
        REQUIRE(context.run_one() != 0);
    }
}

TEST_CASE("a server that is refused comes again", "[net][reverse]")
{
    test::ClientSurroundings around;
    test::LogBook log;
    around.environment.log = &log;
    net::BlockingClient client{reverse_config("urn:another:server"), around.environment};
    Machine machine{0, to_client_at(*client.listen("127.0.0.1", 0))};
    const auto refusals = [&] {
        std::size_t count = 0;
        const std::string_view what = "is not expected: urn:busbar:test:machine at opc.tcp://";
        for (auto at = log.text.find(what); at != std::string::npos;
             at = log.text.find(what, at + 1)) {
            ++count;
        }
        return count;
    };
    CHECK(client.run_until([&] { return refusals() == 3; }));
}

TEST_CASE("one client does not get all connections of a server", "[net][reverse]")
{
    test::ClientSurroundings around;
    asio::io_context context;
    net::ReverseListener listener{context.get_executor(), around.log};
    auto to_client = to_client_at(*listener.listen("127.0.0.1", 0));
    to_client.max_connections = 1;
    Machine machine{0, to_client};
    net::AsyncClient first{context.get_executor(), reverse_config(), around.environment};
    net::AsyncClient second{context.get_executor(), reverse_config(), around.environment};
    first.take_from(listener);
    second.take_from(listener);
    std::optional<bool> is_second_ready;
    int reads = 0;
    const std::function<void()> read = [&] {
        first.call<ReadResponse>(test::read_request(test::state_node),
                                 [&](const Result<ReadResponse>& response) {
                                     REQUIRE(response);
                                     CHECK_FALSE(is_second_ready);
                                     ++reads < 100 ? read() : first.close([] {});
                                 });
    };
    first.connect(10s, [&](const Result<void>& connected) {
        REQUIRE(connected);
        second.connect(10s, [&](const Result<void>& then) { is_second_ready = bool{then}; });
        read();
    });
    while (!is_second_ready) {
        REQUIRE(context.run_one() != 0);
    }
    CHECK(*is_second_ready);
    CHECK(reads == 100);
}

TEST_CASE("a client without a listener is told so", "[net][reverse]")
{
    test::ClientSurroundings around;
    auto config = reverse_config();
    config.reconnect.is_enabled = false;
    net::BlockingClient client{config, around.environment};
    const auto connected = client.connect();
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_ConfigurationError);
}

TEST_CASE("a client does not wait for ever for a server that does not come", "[net][reverse]")
{
    test::ClientSurroundings around;
    net::BlockingClient client{reverse_config(), around.environment};
    REQUIRE(client.listen("127.0.0.1", 0));
    const auto connected = client.connect(20ms);
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_Timeout);
    client.close();
}

TEST_CASE("strangers are refused", "[net][reverse]")
{
    Door door;
    Stranger stranger{door};
    SECTION("another server")
    {
        stranger.say_hello("urn:stranger", "opc.tcp://localhost:4840");
        CHECK(stranger.refusal() == status::Bad_TcpEndpointUrlInvalid);
    }
    SECTION("a client")
    {
        channel::detail::OutputBuffer output;
        channel::detail::write_hello(output, {0, 65'535, 65'535, 0, 0, String{"opc.tcp://a:1"}});
        stranger.say(output.output());
        CHECK(stranger.refusal() == status::Bad_TcpMessageTypeInvalid);
    }
    SECTION("a ReverseHello without end")
    {
        std::array<std::byte, channel::detail::header_size> header{};
        channel::detail::write_frame_header(header,
                                            {channel::detail::MessageType::RHE, 'F', 1'000'000});
        stranger.say(header);
        CHECK(stranger.refusal() == status::Bad_TcpMessageTooLarge);
    }
    SECTION("a ReverseHello of half its texts")
    {
        channel::detail::OutputBuffer output;
        write_reverse_hello(output, test::machine_uri, "opc.tcp://localhost:4840");
        std::vector<std::byte> bytes{output.output().begin(), output.output().end()};
        bytes.resize(20);
        channel::detail::write_frame_header(bytes, {channel::detail::MessageType::RHE, 'F', 20});
        stranger.say(bytes);
        CHECK(stranger.refusal() == status::Bad_TcpEndpointUrlInvalid);
    }
}

TEST_CASE("what waits is bounded in number and time", "[net][reverse]")
{
    net::ReverseListenerLimits limits;
    SECTION("nobody says nothing for long")
    {
        limits.hello_timeout = 10ms;
        Door door{limits};
        Stranger silent{door};
        CHECK(silent.hear().empty());
    }
    SECTION("the right server waits a while, if nobody needs it")
    {
        limits.hold_time = 10ms;
        Door door{limits};
        Stranger expected{door};
        expected.say_hello(test::machine_uri, "opc.tcp://localhost:4840");
        CHECK(expected.hear().empty());
    }
    SECTION("and says nothing meanwhile")
    {
        limits.hold_time = 1h;
        Door door{limits};
        Stranger talker{door};
        talker.say_hello(test::machine_uri, "opc.tcp://localhost:4840");
        talker.say_hello(test::machine_uri, "opc.tcp://localhost:4840");
        CHECK(talker.hear().empty());
    }
    SECTION("the oldest makes room")
    {
        limits.hello_timeout = 1h;
        limits.max_waiting = 2;
        Door door{limits};
        Stranger first{door};
        Stranger second{door};
        Stranger third{door};
        CHECK(first.hear().empty());
        third.say_hello("urn:stranger", "");
        CHECK(third.refusal() == status::Bad_TcpEndpointUrlInvalid);
    }
}

TEST_CASE("a spare connection is kept for long, and the newest is used first", "[net][reverse]")
{
    const net::ReverseListenerLimits limits;
    CHECK(limits.hold_time >= 1h);
    Door door{limits};
    Stranger older{door};
    older.say_hello(test::machine_uri, "opc.tcp://localhost:4840");
    Stranger newer{door};
    newer.say_hello(test::machine_uri, "opc.tcp://localhost:4840");
    Stranger last{door};
    last.say_hello("urn:stranger", "");
    // When it is refused, those who came before it are held.
    CHECK(last.refusal() == status::Bad_TcpEndpointUrlInvalid);
    door.client.connect(10s, [](const Result<void>&) {});
    while (!older.has_news() && !newer.has_news()) {
        REQUIRE(door.context.run_one() != 0);
    }
    CHECK(newer.has_news());
    CHECK_FALSE(older.has_news());
}

TEST_CASE("a client may expect a URL, an application, or both", "[net][reverse]")
{
    using Expected = net::detail::ExpectedServer;
    const std::string uri = "urn:plc";
    const std::string url = "opc.tcp://plc:4840/line";
    CHECK(Expected{uri, url}.is_met_by(uri, url));
    CHECK(Expected{uri, ""}.is_met_by(uri, url));
    CHECK(Expected{"", url}.is_met_by("urn:other", url));
    CHECK(Expected{"", "opc.tcp://PLC/line"}.is_met_by(uri, url));
    CHECK_FALSE(Expected{uri, url}.is_met_by("urn:other", url));
    CHECK_FALSE(Expected{uri, url}.is_met_by(uri, "opc.tcp://plc:4841/line"));
    CHECK_FALSE(Expected{uri, url}.is_met_by(uri, "opc.tcp://plc:4840/other"));
    CHECK_FALSE(Expected{uri, url}.is_met_by(uri, "plc"));
    CHECK_FALSE(Expected{"", ""}.is_met_by(uri, url));
}

} // namespace reverse_test
