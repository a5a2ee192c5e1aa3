#include <catch2/catch.hpp>

#include <thread>

#include <busbar/controller/plc_nodes.hpp>
#include <busbar/controller/plc_task.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/net/client_loop.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/types/attribute.hpp>

#include "support/identity.hpp"

using namespace busbar;
using namespace std::chrono_literals;

namespace {

controller::PlcConfig plc_config()
{
    controller::PlcConfig config;
    controller::PlcVariable& counter = config.variables.emplace_back();
    counter.name = "Counter";
    counter.type = BuiltInType::Int32;
    controller::PlcVariable& level = config.variables.emplace_back();
    level.name = "Level";
    level.type = BuiltInType::Double;
    config.programs.emplace_back().target = "Counter";
    return config;
}

server::ServerConfig server_config(std::uint16_t port)
{
    server::ServerConfig config;
    config.endpoint_url = "opc.tcp://localhost:" + std::to_string(port);
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    config.shutdown_delay = 0ms;
    return config;
}

/// A server with a running PLC on a thread and a port of its own.
class Machine {
public:
    Machine() : port_{*loop_.listen("127.0.0.1", 0)}
    {
        environment_.random = &random_;
        environment_.wall_clock = &clock_;
        environment_.log = &log_;
        environment_.users = &users_;
        environment_.waker = &loop_.waker();
        users_.set_anonymous_access(0xFF);
        server_.emplace(*server::Server::create(server_config(port_), environment_));
        controller::PlcNodesOptions nodes;
        nodes.source = server_->add_source(source_);
        REQUIRE(controller::publish_variables(server_->address_space(), *plc_, nodes));
        task_.start();
        while (task_.statistics().scans == 0) { // until then there are no values
            std::this_thread::yield();
        }
        thread_ = std::thread{[this] { loop_.run(*server_); }};
    }
    ~Machine()
    {
        loop_.stop();
        thread_.join();
        task_.stop();
    }

    [[nodiscard]] std::string url() const { return "opc.tcp://127.0.0.1:" + std::to_string(port_); }
    [[nodiscard]] NodeId node(const char* name)
    {
        return {*server_->address_space().namespace_index("urn:busbar:plc"), name};
    }

private:
    NullLog log_;
    net::SystemWallClock clock_;
    crypto::SystemRandom random_;
    server::PasswordUsers users_;
    std::unique_ptr<controller::Plc> plc_ = *controller::Plc::create(plc_config());
    server::ImageSource source_{plc_->image()};
    net::ServerLoop loop_{log_};
    std::uint16_t port_;
    server::ServerEnvironment environment_;
    std::optional<server::Server> server_;
    controller::PlcTask task_{*plc_, clock_, 1ms};
    std::thread thread_;
};

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
        ReadRequest request;
        request.timestamps_to_return = TimestampsToReturn::Source;
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = node;
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        const auto event = loop.call(request);
        REQUIRE(event);
        const auto response = event->response<ReadResponse>();
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] StatusCode write(const NodeId& node, Variant value)
    {
        WriteRequest request;
        WriteValue& item = request.nodes_to_write.emplace_back();
        item.node_id = node;
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
        item.value = DataValue{std::move(value)};
        const auto event = loop.call(request);
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
