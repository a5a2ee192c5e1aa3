#include <catch2/catch.hpp>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>
#include <asio/write.hpp>

#include <busbar/net/async_client.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/net/reverse_listener.hpp>

#include "machine.hpp"
#include "net/client_driver.hpp"
#include "support/identity.hpp"

namespace client_driver_test {

// How a client leaves connections, and what it does when it is to have another one.

using namespace busbar;
using namespace std::chrono_literals;
using asio::ip::tcp;
using client::ClientState;

namespace {

const channel::SecuritySetting secured{crypto::find_policy_by_name("Basic256Sha256"),
                                       MessageSecurityMode::SignAndEncrypt};

/// A server with a secured endpoint, on a thread of its own.
class SecuredServer {
public:
    SecuredServer()
    {
        users_.set_anonymous_access(0xFF);
        auto config = test::server_config(port);
        config.application_uri = "urn:busbar:test:server";
        config.identity = test::server_identity();
        config.endpoints[0].security = secured;
        server_.emplace(*server::Server::create(config, {.random = &random_,
                                                         .wall_clock = &clock_,
                                                         .log = &log_,
                                                         .validator = &validator_,
                                                         .users = &users_,
                                                         .waker = &loop_.waker()}));
        thread_ = std::thread{[this] { loop_.run(*server_); }};
    }
    ~SecuredServer()
    {
        loop_.stop();
        thread_.join();
    }

private:
    NullLog log_;
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    crypto::InsecureAcceptAnyCertificate validator_;
    server::PasswordUsers users_;
    net::ServerLoop loop_{log_};

public:
    const std::uint16_t port{*loop_.listen("127.0.0.1", 0)};

private:
    std::optional<server::Server> server_;
    std::thread thread_;
};

/// Stands between a client and a server, on a thread of its own, and says nothing to the client of
/// the end of the first connection.
class Relay {
public:
    explicit Relay(std::uint16_t server) : server_{asio::ip::address_v4::loopback(), server}
    {
        accept();
        thread_ = std::thread{[this] { context_.run(); }};
    }
    ~Relay()
    {
        context_.stop();
        thread_.join();
    }
    [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

    std::atomic<int> connections{0};
    /// What the client ended of the first one.
    std::atomic<bool> is_half_closed{false};
    /// What it makes of a byte that comes after.
    std::atomic<bool> is_refused{false};

private:
    struct Pair {
        explicit Pair(asio::io_context& context) : client{context}, server{context} {}
        tcp::socket client;
        tcp::socket server;
        std::array<char, 4'096> to_server{};
        std::array<char, 4'096> to_client{};
        bool is_first{false};
    };
    using Link = std::shared_ptr<Pair>;

    void accept()
    {
        const auto link = std::make_shared<Pair>(context_);
        acceptor_.async_accept(link->client, [this, link](std::error_code error) {
            if (!error) {
                link->is_first = connections++ == 0;
                link->server.connect(server_);
                read_client(link);
                read_server(link);
                accept();
            }
        });
    }
    void read_client(const Link& link)
    {
        link->client.async_read_some(
            asio::buffer(link->to_server), [this, link](std::error_code end, std::size_t size) {
                std::error_code ignored;
                asio::write(link->server, asio::buffer(link->to_server.data(), size), ignored);
                if (!end) {
                    return read_client(link);
                }
                link->server.shutdown(tcp::socket::shutdown_send, ignored);
                is_half_closed = is_half_closed || (link->is_first && end == asio::error::eof);
            });
    }
    void read_server(const Link& link)
    {
        link->server.async_read_some(
            asio::buffer(link->to_client), [this, link](std::error_code end, std::size_t size) {
                std::error_code ignored;
                asio::write(link->client, asio::buffer(link->to_client.data(), size), ignored);
                if (!end) {
                    return read_server(link);
                }
                link->is_first ? try_client(link) : link->client.close();
            });
    }
    /// Sends bytes until the client's system refuses them.
    void try_client(const Link& link)
    {
        std::error_code error;
        asio::write(link->client, asio::buffer("x", 1), error);
        if (error) {
            is_refused = true;
            return;
        }
        asio::post(context_, [this, link] { try_client(link); });
    }

    asio::io_context context_;
    tcp::acceptor acceptor_{context_, {asio::ip::address_v4::loopback(), 0}};
    tcp::endpoint server_;
    std::thread thread_;
};

/// A client of a secured server.
struct SecuredClient : test::ClientSurroundings {
    explicit SecuredClient(std::uint16_t port)
    {
        environment.identity = &test::client_identity();
        environment.validator = &validator;
        client::ClientConfig config;
        config.endpoint_url = "opc.tcp://127.0.0.1:" + std::to_string(port);
        config.application_uri = "urn:busbar:test:client";
        config.peer_close_timeout = 20ms;
        client.emplace(std::move(config), environment);
    }

    crypto::InsecureAcceptAnyCertificate validator;
    std::optional<net::BlockingClient> client;
};

/// A Client that has connected, with its Hello still to be sent.
struct Greeting : test::ClientSurroundings {
    Greeting()
    {
        client.connect(start);
        while (client.poll(start, 16)) {
        }
        const auto order = client.next_order();
        REQUIRE(order);
        client.connected(order->id, start);
        line.emplace(client, order->id);
        REQUIRE_FALSE(line->output().empty());
    }

    const TimePoint start{1h};
    client::Client client{test::client_config("opc.tcp://plc:4840"), environment, start};
    std::optional<net::detail::ClientLine> line;
};

} // namespace

TEST_CASE("a connection that is left says what was to be said, and no more", "[net][client]")
{
    Greeting greeting;
    net::detail::ClientLine& line = *greeting.line;
    const std::size_t size = line.output().size();
    line.set_busy(true);
    line.leave(greeting.start + 2s, false);
    CHECK(greeting.client.output().empty()); // what it says next goes over another one
    CHECK_FALSE(line.has_enough());
    CHECK(line.is_closed());
    CHECK(line.output().size() == size);
    line.consume(size - 1);
    line.leave(greeting.start + 1h, false); // is left already
    CHECK(line.next_deadline() == greeting.start + 2s);
    CHECK(line.output().size() == 1);
    const std::array<std::byte, 8> late{};
    CHECK(line.feed(late, greeting.start));
    SECTION("and is sent it")
    {
        line.consume(1);
    }
    SECTION("or not in time")
    {
        line.handle_deadline(greeting.start + 1s);
        CHECK(line.output().size() == 1);
        line.handle_deadline(greeting.start + 2s);
        CHECK(line.next_deadline() == no_deadline);
    }
    CHECK(line.output().empty());
    CHECK_FALSE(line.has_said_all());
}

TEST_CASE("a connection whose peer is to end it waits for that, for a time", "[net][client]")
{
    Greeting greeting;
    net::detail::ClientLine& line = *greeting.line;
    line.leave(greeting.start + 2s, true);
    CHECK_FALSE(line.has_said_all());
    line.consume(line.output().size());
    CHECK(line.has_said_all());
    CHECK_FALSE(line.is_closed());
    SECTION("until it is late")
    {
        line.handle_deadline(greeting.start + 2s);
    }
    SECTION("or no longer")
    {
        line.stop_waiting();
    }
    CHECK(line.is_closed());
    CHECK_FALSE(line.awaits_peer());
}

TEST_CASE("a client leaves the connection that it asked for endpoints over to the server to close",
          "[net][client]")
{
    const SecuredServer server;
    SecuredClient user{server.port};
    REQUIRE(user.client->connect());
    const auto read = user.client->call<ReadResponse>(test::read_request(test::state_node));
    REQUIRE(read);
    CHECK(read->results[0].value == Variant{std::int32_t{0}});
    user.client->close();
}

TEST_CASE("a client goes on without a server that does not close its connection", "[net][client]")
{
    const SecuredServer server;
    const Relay relay{server.port};
    SecuredClient user{relay.port()};
    REQUIRE(user.client->connect());
    CHECK(relay.is_half_closed);
    CHECK(relay.connections == 2);
    while (!relay.is_refused) {
        REQUIRE(user.client->run_for(1ms));
    }
    CHECK(user.client->call<ReadResponse>(test::read_request(test::state_node)));
}

TEST_CASE("a client whose server resets the connection says so, and tries again", "[net][client]")
{
    asio::io_context context;
    tcp::acceptor server{context, {asio::ip::address_v4::loopback(), 0}};
    test::ClientSurroundings around;
    auto config = test::client_config("opc.tcp://127.0.0.1:" +
                                      std::to_string(server.local_endpoint().port()));
    config.reconnect.first = 1ms;
    net::BlockingClient client{config, around.environment};
    int discoveries = 0;
    client.client().on_state([&](ClientState state, StatusCode) {
        discoveries += state == ClientState::Discovering ? 1 : 0;
    });
    client.client().connect(net::detail::now());
    for (int i = 1; i <= 3; ++i) {
        REQUIRE(client.run_until([&] { return discoveries == i; }, 30s));
        tcp::socket ours = server.accept();
        ours.set_option(asio::socket_base::linger{true, 0});
        ours.close();
        REQUIRE(client.run_until(
            [&] { return client.client().state() != ClientState::Discovering; }, 30s));
        CHECK(client.client().last_error() == status::Bad_ConnectionClosed);
    }
}

TEST_CASE("a client that is given another listener takes nothing from the one before",
          "[net][client][reverse]")
{
    test::ClientSurroundings around;
    asio::io_context context;
    net::ReverseListener before{context.get_executor(), around.log};
    net::ReverseListener after{context.get_executor(), around.log};
    auto config = test::client_config("");
    config.is_reverse = true;
    config.server_uri = test::machine_uri;
    net::AsyncClient client{context.get_executor(), config, around.environment};
    client.take_from(before);
    client.take_from(after);
    net::ReverseConnectConfig reverse;
    for (net::ReverseListener* listener : {&before, &after}) {
        reverse.client_urls.push_back("opc.tcp://127.0.0.1:" +
                                      std::to_string(*listener->listen("127.0.0.1", 0)));
    }
    reverse.first_delay = 1ms;
    reverse.longest_delay = 2ms;
    const test::Machine machine{0, reverse};
    bool is_ready = false;
    client.connect(10s, [&](const Result<void>& connected) { is_ready = bool{connected}; });
    while (!is_ready) {
        REQUIRE(context.run_one() != 0);
    }
    CHECK(client.client().state() == ClientState::Ready);
}

} // namespace client_driver_test
