#include "config.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <busbar/channel/endpoint_url.hpp>

#include "plc_section.hpp"
#include "security_section.hpp"

namespace busbar::example {

namespace {

constexpr std::int64_t most_int = 2'147'483'647;

void read_server(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"name", "application_uri", "address", "port", "host_names",
                 "min_channel_lifetime_ms", "key_log", "nodesets"});
    config.server.application_name = table.text("name", config.server.application_name);
    config.server.application_uri = table.text("application_uri", "");
    config.address = table.text("address", config.address);
    config.port = static_cast<std::uint16_t>(table.integer("port", config.port, 0, 65'535));
    config.server.host_names = table.texts("host_names");
    config.nodesets = table.texts("nodesets");
    auto& limits = config.server.limits;
    limits.min_token_lifetime = std::chrono::milliseconds{table.integer(
        "min_channel_lifetime_ms", limits.min_token_lifetime.count(), 100, 3'600'000)};
    config.key_log = table.text("key_log", "");
#ifndef BUSBAR_KEY_LOG
    if (!config.key_log.empty()) {
        table.fail("key_log", "nothing: this build does not give its keys away");
    }
#endif
}

void read_reverse_connect(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"urls"});
    config.reverse_urls = table.texts("urls");
    for (const std::string& url : config.reverse_urls) {
        if (!channel::EndpointUrl::parse(url)) {
            table.fail("urls", "opc.tcp://host:port of each client");
        }
    }
}

/// Part 4, 5.5.5.1: registered anew after ten minutes at the latest.
void read_discovery(const TomlTable& table, DiscoveryConfig& config)
{
    table.allow({"url", "interval_s", "allow_none"});
    config.url = table.text("url", "");
    if (!config.url.empty() && !channel::EndpointUrl::parse(config.url)) {
        table.fail("url", "opc.tcp://host:port of the discovery server");
    }
    config.interval =
        std::chrono::seconds{table.integer("interval_s", config.interval.count(), 10, 600)};
    config.allows_none = table.flag("allow_none", false);
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

ControllerConfig read_root(const TomlTable& root)
{
    root.allow({"server", "reverse_connect", "discovery", "certificates", "endpoint", "users",
                "limits", "plc"});
    ControllerConfig config;
    read_server(root.table("server"), config);
    read_reverse_connect(root.table("reverse_connect"), config);
    read_discovery(root.table("discovery"), config.discovery);
    read_certificates(root.table("certificates"), config);
    read_limits(root.table("limits"), config.server.limits);
    read_users(root.table("users"), config);
    read_endpoints(root, config);
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
