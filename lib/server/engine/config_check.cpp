#include "config_check.hpp"

#include <algorithm>

#include <busbar/channel/endpoint_url.hpp>

#include "server/users/user_policies.hpp"

namespace busbar::server {

namespace detail {

namespace {

std::string describe(const channel::SecuritySetting& security)
{
    const std::string_view mode = channel::name(security.mode);
    return "endpoint " + std::string{security.policy->name} + " " +
           std::string{mode.empty() ? "Invalid" : mode};
}

/// Part 7, 6.6: a policy names the keys that it may be used with.
bool has_fitting_key(const crypto::SecurityPolicy& policy,
                     const channel::ApplicationIdentity& identity)
{
    const std::size_t bits = identity.certificates.front().key_bits();
    return bits >= policy.min_key_bits && bits <= policy.max_key_bits;
}

std::string check_users(const EndpointConfig& endpoint, const std::string& which,
                        const ServerConfig& config, const ServerEnvironment& environment)
{
    UserStore* users = environment.users;
    if (token_policies(config, endpoint, users).empty()) {
        return which + ": nobody can log in, no kind of user is allowed";
    }
    const bool has_secrets = accepts(endpoint, users, UserTokenType::UserName) ||
                             accepts(endpoint, users, UserTokenType::IssuedToken);
    const bool is_plain = password_policy(endpoint).is_none();
    if (has_secrets && is_plain && !endpoint.allows_plain_passwords) {
        return which + ": passwords would be sent as they are, which is not allowed";
    }
    if (has_secrets && !is_plain && !config.identity) {
        return which + ": encrypted passwords need a certificate and its key";
    }
    if (accepts(endpoint, users, UserTokenType::Certificate) &&
        (!config.identity || certificate_policy(endpoint).is_none())) {
        return which +
               ": user certificates need the server's certificate and a policy to sign with";
    }
    return {};
}

std::string check_endpoint(const EndpointConfig& endpoint, const ServerConfig& config,
                           const ServerEnvironment& environment)
{
    if (endpoint.security.policy == nullptr) {
        return "an endpoint has a security policy that is not known";
    }
    const std::string which = describe(endpoint.security);
    const bool is_none = endpoint.security.policy->is_none();
    const auto mode = endpoint.security.mode;
    if (is_none
            ? mode != MessageSecurityMode::None
            : mode != MessageSecurityMode::Sign && mode != MessageSecurityMode::SignAndEncrypt) {
        return which + ": policy and mode do not go together";
    }
    if (!is_none && (!config.identity || environment.validator == nullptr)) {
        return which + ": needs a certificate, its key and a certificate validator";
    }
    if (!is_none && !has_fitting_key(*endpoint.security.policy, *config.identity)) {
        return which + ": needs a key of " +
               std::to_string(endpoint.security.policy->min_key_bits) + " to " +
               std::to_string(endpoint.security.policy->max_key_bits) + " bits";
    }
    return check_users(endpoint, which, config, environment);
}

std::string check_identity(const ServerConfig& config)
{
    if (!config.identity) {
        return {};
    }
    const auto& [certificates, key] = *config.identity;
    if (certificates.empty()) {
        return "there is a key but no certificate";
    }
    if (!key.belongs_to(certificates.front())) {
        return "the private key does not belong to the certificate";
    }
    if (certificates.front().application_uri() != config.application_uri) {
        // Part 6, 6.2.2
        return "the certificate names \"" + printable(certificates.front().application_uri()) +
               "\" and not the ApplicationUri \"" + config.application_uri + "\"";
    }
    return {};
}

std::string find_contradiction(const ServerConfig& config, const ServerEnvironment& environment)
{
    if (!channel::EndpointUrl::parse(config.endpoint_url)) {
        return "\"" + config.endpoint_url + "\" is no URL like opc.tcp://host:port";
    }
    if (config.application_uri.empty() || config.endpoints.empty()) {
        return "an ApplicationUri and an endpoint are needed";
    }
    if (std::string reason = check_identity(config); !reason.empty()) {
        return reason;
    }
    for (auto at = config.endpoints.begin(); at != config.endpoints.end(); ++at) {
        if (std::string reason = check_endpoint(*at, config, environment); !reason.empty()) {
            return reason;
        }
        if (std::any_of(config.endpoints.begin(), at, [&](const EndpointConfig& other) {
                return other.security == at->security;
            })) {
            return describe(at->security) + ": is there twice";
        }
    }
    return {};
}

} // namespace

void warn_of_deprecated_policies(const ServerConfig& config, LogSink& log)
{
    for (const EndpointConfig& endpoint : config.endpoints) {
        for (const auto* policy : {endpoint.security.policy, endpoint.password_policy}) {
            if (policy != nullptr && policy->is_deprecated) {
                log.write(
                    LogLevel::Warning, "server",
                    "INSECURE: " + describe(endpoint.security) + " uses " +
                        std::string{policy->name} +
                        ", which relies on SHA-1 and is deprecated (Part 7, 6.6). Take it out "
                        "of the configuration as soon as no client needs it any more");
            }
        }
    }
}

} // namespace detail

Checked<void> check_config(const ServerConfig& config, const ServerEnvironment& environment)
{
    if (std::string reason = detail::find_contradiction(config, environment); !reason.empty()) {
        return refuse(
            {status::Bad_ConfigurationError, "server configuration", std::move(reason), {}, {}});
    }
    return {};
}

} // namespace busbar::server
