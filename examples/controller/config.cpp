#include "config.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <busbar/crypto/password_hash.hpp>

#include "plc_section.hpp"

namespace busbar::example {

namespace {

constexpr std::int64_t most_int = 2'147'483'647;

channel::SecuritySetting read_setting(const TomlTable& table)
{
    const auto* policy = crypto::find_policy_by_name(table.text("policy"));
    if (policy == nullptr) {
        std::string names;
        for (const crypto::SecurityPolicy& known : crypto::security_policies()) {
            names += (names.empty() ? "" : ", ") + std::string{known.name};
        }
        table.fail("policy", "one of: " + names);
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

void read_server(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"name", "application_uri", "address", "port", "host_names", "certificates",
                 "trust_all_clients", "min_channel_lifetime_ms"});
    config.server.application_name = table.text("name", config.server.application_name);
    config.server.application_uri = table.text("application_uri", "");
    config.address = table.text("address", config.address);
    config.port = static_cast<std::uint16_t>(table.integer("port", config.port, 0, 65'535));
    config.server.host_names = table.texts("host_names");
    config.certificates = table.text("certificates", config.certificates);
    config.trusts_all_clients = table.flag("trust_all_clients", false);
    auto& limits = config.server.limits;
    limits.min_token_lifetime = std::chrono::milliseconds{table.integer(
        "min_channel_lifetime_ms", limits.min_token_lifetime.count(), 100, 3'600'000)};
}

void read_limits(const TomlTable& table, server::ServerLimits& limits)
{
    table.allow({"connections", "sessions", "nodes_per_read", "nodes_per_write", "nodes_per_browse",
                 "references_per_node", "message_size"});
    const auto number = [&](std::string_view key, auto& limit) {
        limit = static_cast<std::remove_reference_t<decltype(limit)>>(
            table.integer(key, static_cast<std::int64_t>(limit), 1, most_int));
    };
    number("connections", limits.max_connections);
    number("sessions", limits.max_sessions);
    number("nodes_per_read", limits.operations.max_nodes_per_read);
    number("nodes_per_write", limits.operations.max_nodes_per_write);
    number("nodes_per_browse", limits.operations.max_nodes_per_browse);
    number("references_per_node", limits.max_references_per_node);
    number("message_size", limits.transport.max_message_size);
}

/// Whether anonymous users may log in; what they may do goes to `config`.
bool read_users(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"anonymous", "account"});
    const std::string anonymous = table.text("anonymous", "no");
    if (anonymous != "no" && anonymous != "read" && anonymous != "write") {
        table.fail("anonymous", "\"no\", \"read\" or \"write\"");
    }
    config.anonymous_may_write = anonymous == "write";
    for (const TomlTable& entry : table.tables("account")) {
        entry.allow({"name", "password", "access"});
        Account account;
        account.name = entry.text("name");
        account.password_hash = entry.text("password");
        if (!crypto::is_password_hash(account.password_hash)) {
            throw ConfigError{"account \"" + account.name +
                              "\": the password must be the output of --hash-password"};
        }
        const std::string access = entry.text("access", "write");
        if (access != "read" && access != "write") {
            entry.fail("access", "\"read\" or \"write\"");
        }
        account.may_write = access == "write";
        config.accounts.push_back(std::move(account));
    }
    return anonymous != "no";
}

void read_endpoints(const TomlTable& root, bool allows_anonymous, ControllerConfig& config)
{
    const auto tables = root.tables("endpoint");
    if (!tables.empty()) {
        config.server.endpoints.clear();
    }
    for (const TomlTable& table : tables) {
        table.allow({"policy", "mode"});
        config.server.endpoints.emplace_back().security = read_setting(table);
    }
    for (server::EndpointConfig& endpoint : config.server.endpoints) {
        endpoint.allows_anonymous = allows_anonymous;
        endpoint.allows_user_name = !config.accounts.empty();
    }
}

ControllerConfig read_root(const TomlTable& root)
{
    root.allow({"server", "endpoint", "users", "limits", "plc"});
    ControllerConfig config;
    read_server(root.table("server"), config);
    read_limits(root.table("limits"), config.server.limits);
    const bool allows_anonymous = read_users(root.table("users"), config);
    read_endpoints(root, allows_anonymous, config);
    read_plc(root.table("plc"), config);
    return config;
}

} // namespace

ControllerConfig parse_config(std::string_view text, const std::string& file)
{
    try {
        const toml::table table = toml::parse(text, file);
        return read_root(TomlTable{table, file});
    } catch (const toml::parse_error& error) {
        throw ConfigError{file + ":" + std::to_string(error.source().begin.line) + ": " +
                          std::string{error.description()}};
    }
}

ControllerConfig read_config(const std::string& path)
{
    std::ifstream file{path, std::ios::binary};
    if (!file) {
        throw ConfigError{path + ": the file cannot be read"};
    }
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    return parse_config(text, path);
}

} // namespace busbar::example
