#pragma once

#include <catch2/catch.hpp>

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <busbar/client/client.hpp>
#include <busbar/controller/plc_nodes.hpp>
#include <busbar/controller/plc_task.hpp>
#include <busbar/core/attribute_id.hpp>
#include <busbar/net/client_loop.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/types/attribute.hpp>

namespace busbar::test {

inline constexpr const char* machine_uri = "urn:busbar:test:machine";

inline controller::PlcConfig plc_config()
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

inline server::ServerConfig server_config(std::uint16_t port)
{
    server::ServerConfig config;
    config.application_uri = machine_uri;
    config.endpoint_url = "opc.tcp://localhost:" + std::to_string(port);
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    config.shutdown_delay = std::chrono::milliseconds{0};
    return config;
}

/// A server with a running PLC on a thread and a port of its own.
class Machine {
public:
    explicit Machine(std::uint16_t port = 0, net::ReverseConnectConfig reverse = {})
        : port_{*loop_.listen("127.0.0.1", port)}
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
        REQUIRE(loop_.connect_to_clients(std::move(reverse)));
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

    [[nodiscard]] std::uint16_t port() const { return port_; }
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
    controller::PlcTask task_{*plc_, clock_, std::chrono::milliseconds{1}};
    std::thread thread_;
};

/// What a client needs from outside.
struct ClientSurroundings {
    NullLog log;
    net::SystemWallClock clock;
    crypto::SystemRandom random;
    channel::ChannelEnvironment environment{.random = &random, .wall_clock = &clock, .log = &log};
};

/// For a server without security.
inline client::ClientConfig client_config(std::string url)
{
    client::ClientConfig config;
    config.endpoint_url = std::move(url);
    config.security.min_mode = MessageSecurityMode::None;
    config.security.allows_none = true;
    config.reconnect.first = std::chrono::milliseconds{10};
    config.reconnect.longest = std::chrono::milliseconds{50};
    return config;
}

inline ReadRequest read_request(const NodeId& node)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Source;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = node;
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    return request;
}

inline WriteRequest write_request(const NodeId& node, Variant value)
{
    WriteRequest request;
    WriteValue& item = request.nodes_to_write.emplace_back();
    item.node_id = node;
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    item.value = DataValue{std::move(value)};
    return request;
}

/// Server_ServerStatus_State, which every server has.
inline const NodeId state_node{0, 2259};

} // namespace busbar::test
