#include "server.hpp"

#include <chrono>
#include <utility>

#include <busbar/server/method_table.hpp>
#include <busbar/server/worst_case_memory.hpp>

#include "variable_source.hpp"

namespace busbar::c {

namespace {

using std::chrono::milliseconds;

StatusCode take_endpoints(const busbar_server_config& from, FailureText& failure,
                          server::ServerConfig& to)
{
    if (from.endpoints == nullptr) {
        return status::Good;
    }
    to.endpoints.clear();
    for (std::size_t i = 0; i < from.endpoint_count; ++i) {
        const busbar_endpoint& each = from.endpoints[i];
        server::EndpointConfig& endpoint = to.endpoints.emplace_back();
        endpoint.security.policy = crypto::find_policy_by_name(text_or(each.policy, ""));
        if (endpoint.security.policy == nullptr) {
            return misconfigured(failure, "endpoints", i,
                                 "policy is not one that this build knows");
        }
        if (each.mode < BUSBAR_MODE_NONE || each.mode > BUSBAR_MODE_SIGN_AND_ENCRYPT) {
            return misconfigured(failure, "endpoints", i, "mode must be 1, 2 or 3");
        }
        endpoint.security.mode = static_cast<MessageSecurityMode>(each.mode);
        endpoint.allows_anonymous = each.allows_anonymous;
        endpoint.allows_user_name = each.allows_user_name;
    }
    return status::Good;
}

StatusCode take_limits(const busbar_server_config& from, FailureText& failure,
                       server::ServerLimits& to)
{
    if (from.memory_limit != 0) {
        const auto limits = server::limits_for(from.memory_limit);
        if (!limits) {
            return failed(failure, limits.error());
        }
        to = *limits;
    } else if (from.limits == BUSBAR_LIMITS_SMALL) {
        to = server::small_controller_limits();
    } else if (from.limits != BUSBAR_LIMITS_LARGE) {
        return misconfigured(failure, "limits", "is not a preset that this build knows");
    }
    return status::Good;
}

StatusCode take_users(const busbar_server_config& from, FailureText& failure, CallbackUsers& to)
{
    for (std::size_t i = 0; i < from.user_count; ++i) {
        const busbar_user& each = from.users[i];
        server::UserRights rights;
        if (each.is_read_only) {
            rights.access_level_mask = server::anonymous_reader().access_level_mask;
        }
        const auto set =
            to.table().set(std::string{text_or(each.name, "")},
                           std::string{text_or(each.password_hash, "")}, std::move(rights));
        if (!set) {
            return misconfigured(failure, "users", i, "has no name, or no hash of a password",
                                 set.error());
        }
    }
    if (from.anonymous_may_write) {
        to.table().set_anonymous_access(0xFF);
    }
    to.ask(from.login, from.login_context);
    return status::Good;
}

StatusCode take_config(const busbar_server_config& from, busbar_server& made,
                       server::ServerConfig& to)
{
    to.application_uri = made.around.uri();
    to.application_name = made.around.name();
    to.product_uri = text_or(from.product_uri, to.product_uri);
    to.build.manufacturer_name = text_or(from.manufacturer_name, "");
    to.build.software_version = text_or(from.software_version, "");
    to.endpoint_url = "opc.tcp://" + made.around.host() + ":" + std::to_string(made.port);
    to.identity = made.around.identity();
    to.shutdown_delay = milliseconds{from.shutdown_delay_ms};
    const StatusCode taken = take_endpoints(from, made.failure, to);
    return taken.is_bad() ? taken : take_limits(from, made.failure, to.limits);
}

StatusCode create_server(server::ServerConfig&& config, busbar_server& made)
{
    server::ServerEnvironment environment;
    environment.random = &made.around.random();
    environment.wall_clock = &made.around.clock();
    environment.log = &made.around.log();
    environment.validator = made.around.validator();
    environment.users = &made.users;
    environment.waker = &made.loop.waker();
    auto created = server::Server::create(std::move(config), environment);
    if (!created) {
        return failed(made.failure, created.error());
    }
    made.server.emplace(*std::move(created));
    made.variables = std::make_shared<VariableSource>(made.around.clock());
    made.methods = std::make_shared<server::MethodTable>();
    made.server->add_source(made.variables);
    made.server->add_source(made.methods);
    return status::Good;
}

StatusCode create(const busbar_server_config& config, busbar_server& made)
{
    if (const StatusCode opened = made.around.open(config.application, made.failure);
        opened.is_bad()) {
        return opened;
    }
    if (const StatusCode taken = take_users(config, made.failure, made.users); taken.is_bad()) {
        return taken;
    }
    const std::uint16_t wanted = config.takes_free_port ? 0 : config.port == 0 ? 4840 : config.port;
    const auto port = made.loop.reserve(text_or(config.address, ""), wanted);
    if (!port) {
        return misconfigured(made.failure, "port", "cannot be opened for listening", port.error());
    }
    made.port = *port;
    server::ServerConfig to;
    const StatusCode taken = take_config(config, made, to);
    return taken.is_bad() ? taken : create_server(std::move(to), made);
}

StatusCode check_serving(busbar_server& server)
{
    return server.is_serving
               ? failed(server.failure, status::Bad_InvalidState, "a callback cannot serve")
               : status::Good;
}

StatusCode start(busbar_server& server)
{
    if (server.is_started) {
        return failed(server.failure, status::Bad_InvalidState, "the server has started");
    }
    if (const auto listening = server.loop.listen_on_reserved(); !listening) {
        return failed(server.failure, listening.error(), "the port is used by another program");
    }
    server.is_started = true;
    return status::Good;
}

/// Bad_Shutdown once the server has stopped.
StatusCode serve(busbar_server& server, Duration time)
{
    if (const StatusCode checked = check_serving(server); checked.is_bad()) {
        return checked;
    }
    server.is_serving = true;
    const busbar::detail::Undo undo{[&] { server.is_serving = false; }};
    server.is_over = server.is_over || !server.loop.run_for(*server.server, time);
    return server.is_over ? status::Bad_Shutdown : status::Good;
}

bool is_complete(const busbar_server_config* config)
{
    return config != nullptr && config->size == sizeof *config &&
           has_all(config->endpoints, config->endpoint_count) &&
           has_all(config->users, config->user_count) &&
           has_all(config->application.trusted, config->application.trusted_count);
}

} // namespace

void CallbackUsers::ask(busbar_login_callback login, void* context)
{
    login_ = login;
    context_ = context;
}

Result<server::UserIdentity> CallbackUsers::log_in(std::string_view name, std::string_view password)
{
    if (login_ == nullptr || !table_.password_hash(name).empty()) {
        return table_.log_in(name, password);
    }
    const busbar_status answer =
        login_(context_, {name.data(), name.size()}, {password.data(), password.size()});
    if (answer != BUSBAR_GOOD) {
        return fail(status::Bad_UserAccessDenied);
    }
    server::UserIdentity user;
    user.token_type = UserTokenType::UserName;
    user.name = name;
    return user;
}

busbar_status enter(busbar_server* server, FunctionRef<StatusCode()> body) noexcept
{
    if (server == nullptr) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    if (server->created.is_bad()) {
        return server->created.value(); // with the text of busbar_server_create
    }
    return run_guarded(&server->failure, body);
}

busbar_status change(busbar_server* server, FunctionRef<StatusCode()> body) noexcept
{
    return enter(server, [&]() -> StatusCode {
        return server->is_serving ? failed(server->failure, status::Bad_InvalidState,
                                           "a callback cannot change nodes")
                                  : body();
    });
}

} // namespace busbar::c

using namespace busbar;

busbar_server::busbar_server(const busbar_application& application)
    : around{application}, loop{around.log()}
{
}

busbar_server::~busbar_server()
{
    busbar::detail::attempt([this] { loop.end_at_once(); });
}

void busbar_server_config_init(busbar_server_config* config)
{
    if (config != nullptr) {
        *config = busbar_server_config{};
        config->size = sizeof *config;
        config->application.log_level = BUSBAR_LOG_WARNING;
        config->shutdown_delay_ms = 2'000;
    }
}

busbar_status busbar_server_create(const busbar_server_config* config, busbar_server** server)
{
    if (server == nullptr) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    *server = nullptr;
    if (!c::is_complete(config)) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    std::unique_ptr<busbar_server> made;
    const busbar_status status = c::run_guarded(nullptr, [&] {
        made = std::make_unique<busbar_server>(config->application);
        made->created =
            StatusCode{c::run_guarded(&made->failure, [&] { return c::create(*config, *made); })};
        return made->created;
    });
    if (made != nullptr && status != BUSBAR_BAD_OUT_OF_MEMORY) {
        *server = made.release();
    }
    return status;
}

void busbar_server_destroy(busbar_server* server)
{
    delete server;
}

const char* busbar_server_last_error(const busbar_server* server)
{
    return server != nullptr ? server->failure.c_str() : "";
}

busbar_status busbar_server_start(busbar_server* server)
{
    return c::enter(server, [&] { return c::start(*server); });
}

uint16_t busbar_server_port(const busbar_server* server)
{
    return server != nullptr ? server->port : 0;
}

busbar_status busbar_server_poll(busbar_server* server, uint32_t timeout_ms)
{
    return c::enter(server, [&]() -> StatusCode {
        if (!server->is_started) {
            return c::failed(server->failure, status::Bad_InvalidState, "it was not started");
        }
        return c::serve(*server, c::milliseconds{timeout_ms});
    });
}

busbar_status busbar_server_run(busbar_server* server, bool ends_on_signals)
{
    return c::enter(server, [&]() -> StatusCode {
        // Before the signals are taken.
        if (const StatusCode checked = c::check_serving(*server); checked.is_bad()) {
            return checked;
        }
        if (server->is_over) {
            return status::Good;
        }
        if (!server->is_started) {
            if (const StatusCode started = c::start(*server); started.is_bad()) {
                return started;
            }
        }
        if (ends_on_signals) {
            server->loop.stop_on_signals();
        }
        StatusCode served;
        while (served.is_good()) {
            served = c::serve(*server, std::chrono::hours{1});
        }
        return served == status::Bad_Shutdown ? status::Good : served;
    });
}

busbar_status busbar_server_stop(busbar_server* server)
{
    if (server == nullptr || server->created.is_bad()) {
        return server == nullptr ? BUSBAR_BAD_INVALID_ARGUMENT : server->created.value();
    }
    return c::run_guarded(nullptr, [&] { // not with the text, which belongs to the server's thread
        server->loop.stop();
        return status::Good;
    });
}

busbar_status busbar_server_count(const busbar_server* server, busbar_server_counts* counts)
{
    if (server == nullptr || counts == nullptr || counts->size != sizeof *counts) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    if (!server->server) {
        return server->created.value();
    }
    counts->connections = server->server->connection_count();
    counts->sessions = server->server->session_count();
    counts->subscriptions = server->server->subscription_count();
    counts->monitored_items = server->server->monitored_item_count();
    return BUSBAR_GOOD;
}
