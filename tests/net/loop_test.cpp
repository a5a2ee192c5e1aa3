#include <catch2/catch.hpp>

#include <atomic>

#include "machine.hpp"

namespace loop_test {

using namespace busbar;
using namespace std::chrono_literals;
using busbar::test::Machine;

namespace {

/// A client with a session at `machine`.
class Visitor {
public:
    explicit Visitor(const Machine& machine)
    {
        client::ConnectionConfig config;
        config.channel.endpoint_url = machine.url();
        REQUIRE(loop.connect(config, {.random = &random_, .wall_clock = &clock_, .log = &log_}));
        REQUIRE(loop.wait_until_ready());
    }
    [[nodiscard]] DataValue read(const NodeId& node)
    {
        const auto event = loop.call(test::read_request(node));
        REQUIRE(event);
        const auto response = event->response<ReadResponse>();
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] StatusCode write(const NodeId& node, Variant value)
    {
        const auto event = loop.call(test::write_request(node, std::move(value)));
        REQUIRE(event);
        const auto response = event->response<WriteResponse>();
        REQUIRE(response);
        return response->results[0];
    }

    net::ClientLoop loop;

private:
    NullLog log_;
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
};

/// Knows when a text was logged.
class AwaitedLog final : public LogSink {
public:
    explicit AwaitedLog(std::string text) : text_{std::move(text)} {}

    void write(LogLevel, std::string_view, std::string_view text) override
    {
        has_come_ = has_come_ || text.find(text_) != std::string_view::npos;
    }
    void await() const
    {
        while (!has_come_) {
            std::this_thread::yield();
        }
    }

private:
    const std::string text_;
    std::atomic<bool> has_come_{false};
};

} // namespace

TEST_CASE("values of a running PLC are read and written over TCP", "[net][unit:Protocol UA TCP]")
{
    Machine machine;
    Visitor visitor{machine};
    const NodeId counter = machine.node("Counter");
    const auto first = visitor.read(counter).value.value_or(std::int32_t{-1});
    auto next = first;
    for (int i = 0; i < 10'000 && next == first; ++i) {
        next = visitor.read(counter).value.value_or(std::int32_t{-1});
    }
    CHECK(next > first);
    CHECK(visitor.write(machine.node("Level"), Variant{2.5}) == StatusCode{});
    CHECK(visitor.read(machine.node("Level")).value == Variant{2.5});
    visitor.loop.close();
}

TEST_CASE("several clients are served at the same time", "[net]")
{
    Machine machine;
    std::vector<std::unique_ptr<Visitor>> visitors;
    for (int i = 0; i < 4; ++i) {
        visitors.push_back(std::make_unique<Visitor>(machine));
    }
    for (int round = 0; round < 20; ++round) {
        for (const auto& visitor : visitors) {
            CHECK(visitor->read(machine.node("Level")).status == StatusCode{});
        }
    }
    // One goes without a word, the others stay.
    visitors.pop_back();
    CHECK(visitors[0]->read(machine.node("Level")).status == StatusCode{});
}

TEST_CASE("a client is told when the server stops", "[net]")
{
    auto machine = std::make_unique<Machine>();
    Visitor visitor{*machine};
    machine.reset();
    const auto event = visitor.loop.wait();
    REQUIRE(event);
    CHECK(event->kind == client::ConnectionEvent::Kind::Closed);
}

TEST_CASE("nobody there is an error, not a hang", "[net]")
{
    NullLog log;
    net::SystemWallClock clock;
    crypto::SystemRandom random;
    client::ConnectionConfig config;
    config.channel.endpoint_url = "opc.tcp://127.0.0.1:1";
    net::ClientLoop loop;
    const auto connected =
        loop.connect(config, {.random = &random, .wall_clock = &clock, .log = &log});
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_CommunicationError);
}

TEST_CASE("a server that no discovery server takes serves and stops as ever", "[net]")
{
    Machine no_discovery_server;
    AwaitedLog log{"is not registered, will try again: Bad_ServiceUnsupported"};
    net::SystemWallClock clock;
    crypto::SystemRandom random;
    server::PasswordUsers users;
    net::ServerLoop loop{log};
    const auto port = loop.listen("127.0.0.1", 0);
    REQUIRE(port);
    const server::ServerConfig config = test::server_config(*port);
    const channel::ChannelEnvironment surroundings{
        .random = &random, .wall_clock = &clock, .log = &log};

    net::DiscoveryRegistrationConfig registration;
    registration.settings = net::registration_of(config, {config.endpoint_url});
    CHECK(loop.register_with(registration, surroundings).error() ==
          status::Bad_TcpEndpointUrlInvalid);
    client::SecurityWishes wishes;
    wishes.allows_none = true;
    registration.client = client::registration_client(no_discovery_server.url(), wishes,
                                                      config.application_uri, false);
    REQUIRE(loop.register_with(registration, surroundings));
    registration.settings.server.discovery_urls.clear();
    CHECK(loop.register_with(registration, surroundings).error() ==
          status::Bad_DiscoveryUrlMissing);

    const server::ServerEnvironment environment{.random = &random,
                                                .wall_clock = &clock,
                                                .log = &log,
                                                .users = &users,
                                                .waker = &loop.waker()};
    auto server = server::Server::create(config, environment);
    REQUIRE(server);
    std::thread thread{[&] { loop.run(*server); }};
    log.await();
    loop.stop();
    thread.join();
    CHECK(server->is_stopped());
}

} // namespace loop_test
