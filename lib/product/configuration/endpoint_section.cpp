#include "sections.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/security_policy.hpp>

namespace busbar::product {

namespace {

using SecuritySettings = std::vector<channel::SecuritySetting>;

constexpr std::array modes{MessageSecurityMode::None, MessageSecurityMode::Sign,
                           MessageSecurityMode::SignAndEncrypt};

/// Lists all policies but None.
std::string policy_names()
{
    std::string names;
    for (const crypto::SecurityPolicy& known : crypto::security_policies()) {
        if (!known.is_none()) {
            names += (names.empty() ? "" : ", ") + std::string{known.name};
        }
    }
    return names;
}

channel::SecuritySetting read_setting(const TomlTable& table)
{
    const auto* policy = crypto::find_policy_by_name(table.text("policy"));
    if (policy == nullptr) {
        table.fail("policy", "one of: None, " + policy_names());
    }
    const std::string mode = table.text("mode", policy->is_none() ? "None" : "SignAndEncrypt");
    if (policy->is_none()) {
        if (mode != "None") {
            table.fail("mode", "None, the only mode of policy None");
        }
        return {policy, MessageSecurityMode::None};
    }
    if (mode != "Sign" && mode != "SignAndEncrypt") {
        table.fail("mode", "Sign or SignAndEncrypt");
    }
    return {policy,
            mode == "Sign" ? MessageSecurityMode::Sign : MessageSecurityMode::SignAndEncrypt};
}

/// Reads `policies` and `mode` (SH-082679, 9.9): these policies with the mode and every stronger
/// one. If none is named: None, and all that are not deprecated.
SecuritySettings read_policies(const TomlTable& table)
{
    std::vector<const crypto::SecurityPolicy*> policies;
    for (std::string text : table.texts("policies")) {
        std::replace(text.begin(), text.end(), '-', '_');
        const auto* const policy = crypto::find_policy_by_name(text);
        if (policy == nullptr || policy->is_none()) {
            table.fail("policies", "some of: " + policy_names());
        }
        policies.push_back(policy);
    }
    const bool has_none = policies.empty();
    const std::string wanted = table.text("mode", has_none ? "None" : "SignAndEncrypt");
    const auto least = std::find_if(modes.begin(), modes.end(), [&](MessageSecurityMode mode) {
        return channel::name(mode) == wanted;
    });
    if (least == modes.end() || (least == modes.begin()) != has_none) {
        table.fail("mode", has_none ? "None, where there is no policy"
                                    : "Sign or SignAndEncrypt, where there is a policy");
    }
    SecuritySettings settings;
    if (has_none) {
        for (const crypto::SecurityPolicy& each : crypto::security_policies()) {
            if (each.is_none()) {
                settings.push_back({&each, MessageSecurityMode::None});
            } else if (!each.is_deprecated) {
                policies.push_back(&each);
            }
        }
    }
    for (const crypto::SecurityPolicy* policy : policies) {
        for (auto mode = has_none ? modes.begin() + 1 : least; mode != modes.end(); ++mode) {
            settings.push_back({policy, *mode});
        }
    }
    return settings;
}

/// Reads `allow` (W588, 5-2-2): "None", "Sign - Basic256Sha256".
SecuritySettings read_allowed(const TomlTable& table)
{
    SecuritySettings settings;
    for (const std::string& text : table.texts("allow")) {
        const std::size_t hyphen = text.find(" - ");
        const bool is_none = text == "None";
        const auto* const policy = crypto::find_policy_by_name(
            is_none || hyphen == std::string::npos ? text : text.substr(hyphen + 3));
        const auto mode = std::find_if(modes.begin(), modes.end(), [&](MessageSecurityMode each) {
            return channel::name(each) == text.substr(0, is_none ? text.size() : hyphen);
        });
        if (policy == nullptr || mode == modes.end() || policy->is_none() != is_none ||
            (*mode == MessageSecurityMode::None) != is_none) {
            table.fail("allow", "some of: None, and Sign or SignAndEncrypt, \" - \" and one of: " +
                                    policy_names());
        }
        settings.push_back({policy, *mode});
    }
    if (settings.empty()) {
        table.fail("allow", "at least one mode and policy");
    }
    return settings;
}

/// Reads [security], which replaces a list of [[endpoint]].
SecuritySettings read_security(const TomlTable& table)
{
    table.allow({"policies", "mode", "allow"});
    if (table.has("allow")) {
        if (table.has("policies") || table.has("mode")) {
            table.refuse("allow", "found it beside policies or mode, expected one or the other");
        }
        return read_allowed(table);
    }
    if (!table.has("policies")) {
        throw ConfigError{"[security]", "found neither policies nor allow, expected one of them"};
    }
    return read_policies(table);
}

} // namespace

void read_endpoints(const TomlTable& root, ControllerConfig& config)
{
    SecuritySettings settings;
    for (const TomlTable& table : root.tables("endpoint")) {
        table.allow({"policy", "mode"});
        settings.push_back(read_setting(table));
    }
    if (root.has("security")) {
        if (!settings.empty()) {
            root.refuse("security", "found it beside [[endpoint]], expected one or the other");
        }
        settings = read_security(root.table("security"));
    }
    if (!settings.empty()) {
        config.server.endpoints.clear();
    }
    for (const channel::SecuritySetting& setting : settings) {
        config.server.endpoints.emplace_back().security = setting;
    }
    offer_users(config);
}

void offer_users(ControllerConfig& config)
{
    for (server::EndpointConfig& endpoint : config.server.endpoints) {
        endpoint.allows_anonymous = config.users.anonymous.has_value();
        endpoint.allows_user_name = !config.users.accounts.empty();
        endpoint.allows_certificate = config.users.certified.has_value();
        endpoint.allows_issued = config.users.tokens.has_value();
    }
}

} // namespace busbar::product
