#include "config_check.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>

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

/// Part 7, 6.6: a policy limits the keys that it may be used with.
bool has_fitting_key(const crypto::SecurityPolicy& policy,
                     const channel::ApplicationIdentity& identity)
{
    const std::size_t bits = identity.certificates.front().key_bits();
    return bits >= policy.min_key_bits && bits <= policy.max_key_bits;
}

Configured<void> check_users(const EndpointConfig& endpoint, const ServerConfig& config,
                             const ServerEnvironment& environment)
{
    UserStore* users = environment.users;
    const auto wrong = [&](const char* text) {
        return misconfigured(describe(endpoint.security), text);
    };
    if (token_policies(config, endpoint, users).empty()) {
        return wrong("allows no kind of user, so that no user can log in");
    }
    const bool has_secrets = accepts(endpoint, users, UserTokenType::UserName) ||
                             accepts(endpoint, users, UserTokenType::IssuedToken);
    const bool is_plain = password_policy(endpoint).is_none();
    if (has_secrets && is_plain && !endpoint.allows_plain_passwords) {
        return wrong("passwords would be sent unencrypted, which is not allowed");
    }
    if (has_secrets && !is_plain && !config.identity) {
        return wrong("encrypted passwords need a certificate and its key");
    }
    if (accepts(endpoint, users, UserTokenType::Certificate) &&
        (!config.identity || certificate_policy(endpoint).is_none())) {
        return wrong("user certificates need the server's certificate and a policy to sign with");
    }
    return {};
}

Configured<void> check_endpoint(const EndpointConfig& endpoint, const ServerConfig& config,
                                const ServerEnvironment& environment)
{
    const crypto::SecurityPolicy& policy = *endpoint.security.policy;
    const std::string which = describe(endpoint.security);
    const auto mode = endpoint.security.mode;
    if (policy.is_none()
            ? mode != MessageSecurityMode::None
            : mode != MessageSecurityMode::Sign && mode != MessageSecurityMode::SignAndEncrypt) {
        return misconfigured(which, "policy and mode do not go together");
    }
    if (!policy.is_none() && (!config.identity || environment.validator == nullptr)) {
        return misconfigured(which, "needs a certificate, its key and a certificate validator");
    }
    if (!policy.is_none() && !has_fitting_key(policy, *config.identity)) {
        return misconfigured(which, "needs a key of " + std::to_string(policy.min_key_bits) +
                                        " to " + std::to_string(policy.max_key_bits) + " bits");
    }
    return check_users(endpoint, config, environment);
}

Configured<void> check_endpoints(const ServerConfig& config, const ServerEnvironment& environment)
{
    const auto& endpoints = config.endpoints;
    if (endpoints.empty()) {
        return misconfigured("endpoints", "there is no endpoint, expected one at least");
    }
    for (auto at = endpoints.begin(); at != endpoints.end(); ++at) {
        if (at->security.policy == nullptr) {
            return misconfigured("endpoint " + std::to_string(at - endpoints.begin() + 1),
                                 "its security policy is not known");
        }
        if (auto checked = check_endpoint(*at, config, environment); !checked) {
            return checked;
        }
        if (std::any_of(endpoints.begin(), at, [&](const EndpointConfig& other) {
                return other.security == at->security;
            })) {
            return misconfigured(describe(at->security), "is there twice");
        }
    }
    return {};
}

Configured<void> check_identity(const ServerConfig& config)
{
    if (!config.identity) {
        return {};
    }
    const auto& [certificates, key] = *config.identity;
    if (certificates.empty()) {
        return misconfigured("identity", "there is a key but no certificate");
    }
    if (!key.belongs_to(certificates.front())) {
        return misconfigured("identity", "the private key does not belong to the certificate");
    }
    if (!certificates.front().is_of_application(config.application_uri)) {
        // Part 6, 6.2.2
        return misconfigured("identity", "the certificate names \"" +
                                             printable(certificates.front().application_uri()) +
                                             "\" and not the ApplicationUri \"" +
                                             printable(config.application_uri) + "\"");
    }
    return {};
}

/// One operation too many is Bad_TooManyOperations, which an array that is too long would hide.
Configured<void> check_operations(const ServerLimits& limits)
{
    const OperationLimits& most = limits.operations;
    struct Row {
        std::string_view name;
        std::uint32_t limit;
    };
    const std::array rows{
        Row{"max_nodes_per_read", most.max_nodes_per_read},
        Row{"max_nodes_per_write", most.max_nodes_per_write},
        Row{"max_nodes_per_browse", most.max_nodes_per_browse},
        Row{"max_nodes_per_register_nodes", most.max_nodes_per_register_nodes},
        Row{"max_nodes_per_translate_browse_paths", most.max_nodes_per_translate_browse_paths},
        Row{"max_nodes_per_method_call", most.max_nodes_per_method_call},
        Row{"max_nodes_per_node_management", most.max_nodes_per_node_management},
        Row{"max_monitored_items_per_call", most.max_monitored_items_per_call},
    };
    for (const Row& row : rows) {
        if (row.limit >= limits.decode.max_array_length) {
            return misconfigured("limits.operations." + std::string{row.name},
                                 "is " + std::to_string(row.limit) +
                                     ", expected less than limits.decode.max_array_length, " +
                                     std::to_string(limits.decode.max_array_length));
        }
    }
    return {};
}

/// Checks the requirements of ChannelGuard.
Configured<void> check_channels(const ServerLimits& limits)
{
    using Milliseconds = std::chrono::milliseconds;
    const auto wrong = [](std::string_view limit, std::string text) {
        return misconfigured("limits." + std::string{limit}, std::move(text));
    };
    constexpr std::size_t most = 1'000'000;
    for (const auto& [name, limit] :
         {std::pair{"max_channel_burst", limits.max_channel_burst},
          std::pair{"max_channel_failures", limits.max_channel_failures},
          std::pair{"max_channel_entries", limits.max_channel_entries}}) {
        if (limit == 0 || limit > most) {
            return wrong(name, "is " + std::to_string(limit) + ", expected 1 to 1000000");
        }
    }
    constexpr Milliseconds longest{3'600'000};
    for (const auto& [name, time] :
         {std::pair{"channel_interval", limits.channel_interval},
          std::pair{"failed_channel_interval", limits.failed_channel_interval},
          std::pair{"max_channel_delay", limits.max_channel_delay}}) {
        if (time < Milliseconds::zero() || time > longest) {
            return wrong(name, "is " + std::to_string(time.count()) + " ms, expected 0 to 3600000");
        }
    }
    if (limits.failed_channel_interval < limits.channel_interval) {
        return wrong("failed_channel_interval", "is shorter than channel_interval");
    }
    return {};
}

Configured<void> check_environment(const ServerEnvironment& environment)
{
    const auto missing = [](const char* field) {
        return misconfigured(field, "is null, but a server needs it");
    };
    if (environment.random == nullptr) {
        return missing("environment.random");
    }
    if (environment.wall_clock == nullptr) {
        return missing("environment.wall_clock");
    }
    if (environment.log == nullptr) {
        return missing("environment.log");
    }
    return {};
}

} // namespace

void warn_of_deprecated_policies(const ServerConfig& config, LogSink& log)
{
    for (const EndpointConfig& endpoint : config.endpoints) {
        for (const auto* policy : {endpoint.security.policy, endpoint.password_policy}) {
            if (policy != nullptr && policy->is_deprecated) {
                log.write(LogLevel::Warning, "server",
                          "INSECURE: " + describe(endpoint.security) + " uses " +
                              std::string{policy->name} +
                              ", which relies on SHA-1 and is deprecated (Part 7, 6.6). Remove it "
                              "from the configuration as soon as no client needs it any more");
            }
        }
    }
}

} // namespace detail

Configured<void> check_config(const ServerConfig& config, const ServerEnvironment& environment)
{
    if (auto checked = detail::check_environment(environment); !checked) {
        return checked;
    }
    if (!channel::EndpointUrl::parse(config.endpoint_url)) {
        return misconfigured("endpoint_url", "\"" + printable(config.endpoint_url) +
                                                 "\" is not a URL like opc.tcp://host:port");
    }
    for (const std::string& url : config.further_urls) {
        if (!channel::EndpointUrl::parse(url)) {
            return misconfigured("further_urls", "\"" + printable(url) +
                                                     "\" is not a URL like opc.tcp://host:port");
        }
    }
    if (config.application_uri.empty()) {
        return misconfigured("application_uri", "is empty, expected an URI");
    }
    if (auto checked = detail::check_identity(config); !checked) {
        return checked;
    }
    if (auto checked = detail::check_operations(config.limits); !checked) {
        return checked;
    }
    if (auto checked = detail::check_channels(config.limits); !checked) {
        return checked;
    }
    return detail::check_endpoints(config, environment);
}

} // namespace busbar::server
