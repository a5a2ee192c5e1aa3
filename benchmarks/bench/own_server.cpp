#include "own_server.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <busbar/crypto/random.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#include <busbar/net/worker_thread.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/types/ids.hpp>

#include "identity.hpp"

namespace busbar::bench {

namespace {

/// Another endpoint, and a certificate for it.
bool secure(server::ServerConfig& config, DateTime now)
{
    auto identity = make_identity(now);
    if (!identity) {
        return false;
    }
    config.application_uri = identity->certificates.front().application_uri();
    config.identity = *std::move(identity);
    server::EndpointConfig endpoint = config.endpoints.front();
    endpoint.security = {crypto::find_policy_by_name("Basic256Sha256"),
                         MessageSecurityMode::SignAndEncrypt};
    config.endpoints.push_back(endpoint);
    config.limits.max_connections_per_address = config.limits.max_connections;
    return true;
}

/// The one user, and names and passwords on the secure endpoint.
bool add_user(server::ServerConfig& config, server::PasswordUsers& users, crypto::Random& random)
{
    config.endpoints.back().allows_user_name = true;
    return users.add(good_user, good_password, random).has_value();
}

/// Below the Objects folder.
Result<void> add_variables(server::Server& server, server::MemorySource& source, std::size_t count)
{
    if (count == 0) {
        return {};
    }
    model::AddressSpace& space = server.address_space();
    const auto index = space.add_namespace("urn:busbar:bench:variables");
    if (!index) {
        return fail(index.error());
    }
    model::NewNode node;
    node.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int16};
    variable.access_level = model::Access::ReadWrite;
    variable.source = server.add_source(source);
    for (std::size_t i = 0; i < count; ++i) {
        const std::string name = "Bulk" + std::to_string(i);
        node.id = NodeId{*index, String::borrow(name)};
        node.browse_name = QualifiedName{*index, String::borrow(name)};
        variable.handle = source.add(Variant{static_cast<std::int16_t>(i)});
        if (const auto added = space.add_variable(node, variable); !added) {
            return fail(added.error());
        }
    }
    return {};
}

void enlarge(server::ServerLimits& limits)
{
    constexpr std::size_t plenty = 10'000;
    limits.max_connections = plenty;
    limits.max_connections_per_address = plenty;
    limits.max_sessions = plenty;
    limits.max_sessions_per_user = plenty;
    limits.subscriptions.max_subscriptions = plenty;
    limits.subscriptions.max_subscriptions_per_user = plenty;
}

/// Serves until it is told to stop, and writes the port to `pipe`, or 0 if there is none.
int serve(int pipe, const OwnServerOptions& options)
{
    NullLog log;
    net::SystemWallClock wall_clock;
    crypto::SystemRandom random;
    net::ServerLoop loop{log};
    const std::uint16_t port = loop.listen("127.0.0.1", 0).value_or(0);
    server::ServerConfig config;
    config.endpoint_url = "opc.tcp://127.0.0.1:" + std::to_string(port);
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    config.shutdown_delay = std::chrono::milliseconds{0};
    crypto::InsecureAcceptAnyCertificate validator;
    if (options.is_secure && !secure(config, wall_clock.now())) {
        return 1;
    }
    net::WorkerThread worker{64, &log};
    server::PasswordUsers users;
    users.set_worker(&worker);
    users.set_anonymous_access(static_cast<std::uint8_t>(
        options.variables == 0 ? model::Access::Read : model::Access::ReadWrite));
    if (options.has_user && !add_user(config, users, random)) {
        return 1;
    }
    if (options.is_unrationed) {
        config.limits.channel_interval = std::chrono::milliseconds{0};
        config.limits.failed_channel_interval = std::chrono::milliseconds{0};
    }
    if (options.is_large) {
        enlarge(config.limits);
    }
    std::optional<net::WorkerThread> channel_worker;
    if (options.has_worker) {
        channel_worker.emplace();
    }
    const server::ServerEnvironment environment{
        .random = &random,
        .wall_clock = &wall_clock,
        .log = &log,
        .validator = &validator,
        .users = &users,
        .waker = &loop.waker(),
        .channel_worker = channel_worker ? &*channel_worker : nullptr,
    };
    server::MemorySource source{wall_clock};
    auto server = server::Server::create(std::move(config), environment);
    const bool is_ready = server && add_variables(*server, source, options.variables);
    const std::uint16_t told = is_ready ? port : 0;
    if (::write(pipe, &told, sizeof told) != sizeof told || told == 0) {
        return 1;
    }
    loop.stop_on_signals();
    loop.run(*server);
    return 0;
}

} // namespace

Result<std::unique_ptr<OwnServer>> OwnServer::start(const OwnServerOptions& options)
{
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) != 0) {
        return fail(status::Bad_CommunicationError);
    }
    const pid_t process = ::fork();
    if (process == 0) {
        ::close(pipe[0]);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::_exit(serve(pipe[1], options));
    }
    ::close(pipe[1]);
    std::uint16_t port = 0;
    const bool is_told = process > 0 && ::read(pipe[0], &port, sizeof port) == sizeof port;
    ::close(pipe[0]);
    if (process <= 0) {
        return fail(status::Bad_CommunicationError);
    }
    std::unique_ptr<OwnServer> server{new OwnServer{process, port}};
    if (!is_told || port == 0) {
        return fail(status::Bad_CommunicationError);
    }
    return server;
}

OwnServer::OwnServer(pid_t process, int port)
    : process_{process}, url_{"opc.tcp://127.0.0.1:" + std::to_string(port)}
{
}

OwnServer::~OwnServer()
{
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

} // namespace busbar::bench
