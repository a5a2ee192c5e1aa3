#include <catch2/catch.hpp>

#include "machine.hpp"

using namespace busbar;
using namespace std::chrono_literals;
using test::Machine;

namespace {

/// A client with a session at `machine`.
class Visitor {
public:
    explicit Visitor(const Machine& machine)
    {
        client::ConnectionConfig config;
        config.channel.endpoint_url = machine.url();
        REQUIRE(loop.connect(config, {&random_, &clock_, &log_, nullptr, nullptr}));
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

} // namespace

TEST_CASE("values of a running PLC are read and written over TCP", "[net]")
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
    const auto connected = loop.connect(config, {&random, &clock, &log, nullptr, nullptr});
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_CommunicationError);
}
