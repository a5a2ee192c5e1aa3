#include "plant.hpp"

#include <cstdio>
#include <cstdlib>

#include <busbar/harness/client_host.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/server_host.hpp>
#include <busbar/types/ids.hpp>

using namespace std::chrono_literals;

namespace busbar::bench {

namespace {

channel::ApplicationIdentity make_identity(const char* name)
{
    harness::IdentityOptions options;
    options.name = name;
    return expect("a key", harness::make_identity(options));
}

} // namespace

void give_up(std::string_view what, StatusCode status)
{
    std::fprintf(stderr, "busbar-client-bench: %s: %s\n", std::string{what}.c_str(),
                 std::string{name(status)}.c_str());
    std::exit(1);
}

Plant::Plant(bool is_secure)
{
    if (is_secure) {
        security_ = {crypto::find_policy_by_name("Basic256Sha256"),
                     MessageSecurityMode::SignAndEncrypt};
        client_identity_ = make_identity("client");
        server_identity_ = make_identity("server");
    }
    create_server();
    add_variables();
}

client::ClientConfig Plant::client_config() const
{
    client::ClientConfig config = harness::open_client_config();
    config.security.min_mode = security_.mode;
    config.security.allows_none = security_.mode == MessageSecurityMode::None;
    config.request_timeout = 1h; // the time is virtual
    return config;
}

client::ConnectionConfig Plant::connection_config() const
{
    client::ConnectionConfig config = harness::open_connection_config();
    config.channel.security = security_;
    if (server_identity_) {
        config.channel.server_certificate = server_identity_->certificates.front();
    }
    return config;
}

void Plant::pass(Duration time)
{
    now += time;
    clock_.time.ticks += time.count() / 100;
    server_->handle_deadline(now);
}

void Plant::set_all(std::uint32_t value)
{
    const DateTime time = clock_.now();
    for (std::uint32_t i = 0; i < variable_count; ++i) {
        memory_.set(i, value, {}, time);
    }
}

void Plant::create_server()
{
    server::ServerConfig config = harness::open_server_config();
    config.endpoints[0].security = security_;
    config.identity = server_identity_;
    config.limits.min_session_timeout = config.limits.max_session_timeout;
    server_.emplace(
        expect("a server", server::Server::create(std::move(config), {.random = &random_,
                                                                      .wall_clock = &clock_,
                                                                      .log = &log_,
                                                                      .validator = &validator_,
                                                                      .waker = &waker_})));
    server_->start(now);
}

void Plant::add_variables()
{
    const std::uint32_t source = server_->add_source(memory_);
    for (std::uint32_t i = 0; i < variable_count; ++i) {
        model::NewVariable variable;
        variable.source = source;
        variable.handle = memory_.add(std::uint32_t{0});
        variable.data_type = NodeId{0, id::UInt32};
        model::NewNode node;
        node.id = NodeId{1, i};
        node.browse_name = QualifiedName{1, String{std::to_string(i)}};
        node.parent = server_->address_space().find(id::ObjectsFolder);
        static_cast<void>(server_->address_space().add_variable(node, variable));
    }
}

} // namespace busbar::bench
