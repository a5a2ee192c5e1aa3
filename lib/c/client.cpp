#include "client.hpp"

#include <chrono>
#include <string>
#include <utility>

#include <busbar/client/client.hpp>
#include <busbar/client/config_check.hpp>

namespace busbar::c {

namespace {

using std::chrono::milliseconds;

StatusCode take_config(const busbar_client_config& from, busbar_client& made,
                       client::ClientConfig& to)
{
    to.endpoint_url = text_or(from.url, "");
    to.application_uri = made.around.uri();
    to.application_name = made.around.name();
    if (from.policy != nullptr) {
        to.security.policies = {from.policy};
    }
    if (from.least_mode < BUSBAR_MODE_NONE || from.least_mode > BUSBAR_MODE_SIGN_AND_ENCRYPT) {
        return misconfigured(made.failure, "least_mode", "must be 1, 2 or 3");
    }
    to.security.allows_none = from.least_mode == BUSBAR_MODE_NONE;
    to.security.min_mode = to.security.allows_none
                               ? MessageSecurityMode::Sign
                               : static_cast<MessageSecurityMode>(from.least_mode);
    if (from.user_name != nullptr) {
        to.identity = client::NamedUser{from.user_name, std::string{text_or(from.password, "")}};
    }
    if (from.request_timeout_ms != 0) {
        to.request_timeout = milliseconds{from.request_timeout_ms};
    }
    if (from.session_timeout_ms != 0) {
        to.session_timeout = milliseconds{from.session_timeout_ms};
    }
    return status::Good;
}

StatusCode create(const busbar_client_config& config, busbar_client& made)
{
    if (const StatusCode opened = made.around.open(config.application, made.failure);
        opened.is_bad()) {
        return opened;
    }
    client::ClientConfig to;
    if (const StatusCode taken = take_config(config, made, to); taken.is_bad()) {
        return taken;
    }
    made.environment.random = &made.around.random();
    made.environment.wall_clock = &made.around.clock();
    made.environment.log = &made.around.log();
    made.environment.validator = made.around.validator();
    made.environment.identity = made.around.identity() ? &*made.around.identity() : nullptr;
    if (auto checked = client::check_config(to, made.environment); !checked) {
        return failed(made.failure, checked.error());
    }
    made.client.emplace(std::move(to), made.environment);
    if (config.state != nullptr) {
        made.client->client().on_state([&made, call = config.state, context = config.state_context](
                                           client::ClientState state, StatusCode why) {
            const InCallback running{made};
            call(context, static_cast<int>(state), why.value());
        });
    }
    return status::Good;
}

} // namespace

busbar_status enter(busbar_client* client, FunctionRef<StatusCode()> body) noexcept
{
    if (client == nullptr) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    if (client->created.is_bad()) {
        return client->created.value(); // with the text of busbar_client_create
    }
    return run_guarded(&client->failure, body);
}

busbar_status wait(busbar_client* client, FunctionRef<StatusCode()> body) noexcept
{
    return enter(client, [&]() -> StatusCode {
        return client->is_in_callback ? failed(client->failure, status::Bad_RequestInterrupted,
                                               "a callback cannot wait")
                                      : body();
    });
}

} // namespace busbar::c

using namespace busbar;

void busbar_client_config_init(busbar_client_config* config)
{
    if (config != nullptr) {
        *config = busbar_client_config{};
        config->size = sizeof *config;
        config->application.log_level = BUSBAR_LOG_WARNING;
        config->least_mode = BUSBAR_MODE_SIGN_AND_ENCRYPT;
    }
}

busbar_status busbar_client_create(const busbar_client_config* config, busbar_client** client)
{
    if (client == nullptr) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    *client = nullptr;
    if (config == nullptr || config->size != sizeof *config ||
        !c::has_all(config->application.trusted, config->application.trusted_count)) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    std::unique_ptr<busbar_client> made;
    const busbar_status status = c::run_guarded(nullptr, [&] {
        made = std::make_unique<busbar_client>(config->application);
        made->created =
            StatusCode{c::run_guarded(&made->failure, [&] { return c::create(*config, *made); })};
        return made->created;
    });
    if (made != nullptr && status != BUSBAR_BAD_OUT_OF_MEMORY) {
        *client = made.release();
    }
    return status;
}

void busbar_client_destroy(busbar_client* client)
{
    delete client;
}

const char* busbar_client_last_error(const busbar_client* client)
{
    return client != nullptr ? client->failure.c_str() : "";
}

busbar_status busbar_client_connect(busbar_client* client, uint32_t timeout_ms)
{
    return c::wait(client, [&]() -> StatusCode {
        const auto connected = client->client->connect(c::milliseconds{timeout_ms});
        if (connected) {
            return status::Good;
        }
        const StatusCode why = client->client->client().last_error();
        std::string text{name(connected.error())};
        if (why.is_bad() && why != connected.error()) {
            text += ", the last attempt failed with " + std::string{name(why)};
        }
        return c::failed(client->failure, connected.error(), text);
    });
}

busbar_status busbar_client_disconnect(busbar_client* client)
{
    return c::wait(client, [&]() -> StatusCode {
        return client->client->close() ? status::Good : status::Bad_RequestInterrupted;
    });
}

int busbar_client_state(const busbar_client* client)
{
    // BlockingClient has no constant access.
    auto* const changeable = const_cast<busbar_client*>(client);
    return changeable != nullptr && changeable->client
               ? static_cast<int>(changeable->client->client().state())
               : BUSBAR_CLIENT_CLOSED;
}

busbar_status busbar_client_poll(busbar_client* client, uint32_t timeout_ms)
{
    return c::wait(client, [&]() -> StatusCode {
        return client->client->run_for(c::milliseconds{timeout_ms})
                   ? status::Good
                   : status::Bad_RequestInterrupted;
    });
}

busbar_status busbar_client_run(busbar_client* client)
{
    return c::wait(client, [&]() -> StatusCode {
        client->client->run_for(Duration::max());
        return status::Good;
    });
}

busbar_status busbar_client_interrupt(busbar_client* client)
{
    if (client == nullptr || !client->client) {
        return client == nullptr ? BUSBAR_BAD_INVALID_ARGUMENT : client->created.value();
    }
    client->client->interrupt();
    return BUSBAR_GOOD;
}
