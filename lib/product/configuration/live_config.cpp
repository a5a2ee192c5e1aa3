#include "live_config.hpp"

#include <algorithm>
#include <utility>

#include <busbar/server/running_server.hpp>

#include "limit_keys.hpp"

namespace busbar::product {

namespace {

bool is_same(const server::EndpointConfig& a, const server::EndpointConfig& b)
{
    return a.security == b.security && a.allows_anonymous == b.allows_anonymous &&
           a.allows_user_name == b.allows_user_name && a.password_policy == b.password_policy &&
           a.allows_plain_passwords == b.allows_plain_passwords &&
           a.allows_certificate == b.allows_certificate &&
           a.certificate_policy == b.certificate_policy && a.allows_issued == b.allows_issued;
}

} // namespace

LiveConfig::LiveConfig(server::Server& server, const Administered& administered,
                       const ControllerConfig& started, LogSink& log)
    : server_{server}, administered_{administered}, started_{started}, log_{log}
{
}

server::ServerConfig LiveConfig::next(const ControllerConfig& config) const
{
    ControllerConfig offered;
    offered.users = started_.users;
    offered.users.anonymous = config.users.anonymous;
    offered.server.endpoints = config.server.endpoints;
    offer_users(offered);
    administered_.offer_logins(offered.server.endpoints);

    server::ServerConfig next = server_.config();
    ControllerConfig running;
    running.server.limits = next.limits;
    next.application_name = config.server.application_name;
    next.endpoints = std::move(offered.server.endpoints);
    ControllerConfig taken;
    taken.server.limits = config.server.limits;
    for (const LimitKey& key : limit_keys()) {
        if (!key.is_live && !key.cost.empty()) {
            key.set(taken, key.get(running));
        }
    }
    next.limits = std::move(taken.server.limits);
    return next;
}

Configured<void> LiveConfig::check(const ControllerConfig& config) const
{
    return server::RunningServer{server_}.check(next(config));
}

void LiveConfig::apply(const ControllerConfig& config) const
{
    const auto done = server::RunningServer{server_}.reconfigure(next(config));
    if (!done) {
        log_.write(LogLevel::Error, "controller",
                   text(done.error()) + "; the server goes on as it was");
    }
}

void LiveConfig::apply_offer(const ControllerConfig& config) const
{
    const auto wanted = next(config).endpoints;
    const auto& offered = server_.config().endpoints;
    if (!std::ranges::equal(wanted, offered,
                            [](const auto& a, const auto& b) { return is_same(a, b); })) {
        apply(config);
    }
}

std::string reload(const std::string& path, Settings& settings, Admission& admission, DateTime now)
{
    std::string text = "read again: ";
    if (!path.empty()) {
        Admission::Users users;
        settings.read_again(
            [&](const ControllerConfig& config) { users = admission.prepare(config.users, path); });
        admission.admit(std::move(users)); // which cannot fail: the file counts as a whole
        text +=
            std::to_string(settings.config().users.accounts.size()) + " accounts of " + path + ", ";
    }
    return text + admission.read_certificates(now) +
           "; open sessions continue, and settings that cannot change at once take effect after a "
           "restart";
}

} // namespace busbar::product
