#include "config.hpp"

#include <algorithm>
#include <string_view>

#include <arpa/inet.h>

#include <busbar/channel/endpoint_url.hpp>

#include "core/utf8.hpp"
#include "limit_keys.hpp"
#include "product/configuration/default_config.hpp"
#include "product/machine/program_file.hpp"
#include "sections.hpp"
#include "toml.hpp"

namespace busbar::product {

namespace {

/// Maximum size of a configuration.
constexpr std::size_t max_config_size = 4U << 20U;

bool is_any_address(const std::string& text)
{
    in6_addr buffer{};
    const std::string without_zone = text.substr(0, text.find('%'));
    return ::inet_pton(AF_INET, text.c_str(), &buffer) == 1 ||
           ::inet_pton(AF_INET6, without_zone.c_str(), &buffer) == 1;
}

bool is_host(const std::string& text)
{
    channel::EndpointUrl url;
    url.host = text;
    const auto parsed = channel::EndpointUrl::parse(url.text());
    return parsed && parsed->host == text && parsed->path.empty() &&
           (text.find(':') == std::string::npos || is_any_address(text));
}

/// True for a language, optionally with a hyphen and a country (Part 3, 8.4).
bool is_locale(const std::string& text)
{
    const auto is_short = [](std::string_view part) {
        return (part.size() == 2 || part.size() == 3) &&
               std::all_of(part.begin(), part.end(), [](char c) {
                   return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9');
               });
    };
    const std::string_view all{text};
    const std::size_t hyphen = all.find('-');
    return is_short(all.substr(0, hyphen)) &&
           (hyphen == std::string_view::npos || is_short(all.substr(hyphen + 1)));
}

/// Reads [plc]. A variable that it names may be missing because the program's file is not
/// understood up to its end: then that is said first.
void read_plc_of_program(const TomlTable& table, ControllerConfig& config)
{
    try {
        read_plc(table, config);
    } catch (const ConfigError& error) {
        const MachineConfig& machine = config.machine;
        const auto left_out = machine.program != nullptr
                                  ? left_out_texts(machine.program->program(), machine.program_name)
                                  : std::vector<std::string>{};
        if (left_out.empty()) {
            throw;
        }
        throw ConfigError{"", left_out.front() + "; " + error.what()};
    }
}

} // namespace

void check_name(const TomlTable& table, std::string_view key, std::string_view name)
{
    if (!busbar::detail::is_name(name)) {
        table.fail(key, "a name without control characters and without spaces at its ends");
    }
    if (name.size() > busbar::detail::max_browse_name) {
        table.refuse(key, "found a name of " + std::to_string(name.size()) +
                              " bytes, expected at most " +
                              std::to_string(busbar::detail::max_browse_name) +
                              ", the limit of a BrowseName");
    }
}

namespace {

/// Reads the URLs at which port maps offer the server: a client that uses one gets endpoints with
/// it, and a certificate that the controller makes has its host.
void read_announced(const TomlTable& table, ControllerConfig& config)
{
    for (const std::string& text : table.texts("announce")) {
        const auto url = channel::EndpointUrl::parse(text);
        if (!url || !is_host(url->host)) {
            table.fail("announce", "opc.tcp://host:port of each port map that leads to the server");
        }
        config.server.further_urls.push_back(text);
        auto& hosts = config.host_names;
        if (std::find(hosts.begin(), hosts.end(), url->host) == hosts.end()) {
            hosts.push_back(url->host);
        }
    }
}

void read_server(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"name", "application_uri", "address", "port", "host_names", "announce",
                 "min_channel_lifetime_ms", "key_log", "nodesets", "nodesets_strict", "locales",
                 "auditing"});
    config.server.application_name = table.text("name", config.server.application_name);
    check_name(table, "name", config.server.application_name);
    config.server.application_uri = table.text("application_uri", "");
    config.address = table.text("address", config.address);
    if (!config.address.empty() && !is_any_address(config.address)) {
        table.fail("address", "an IPv4 or IPv6 address of this machine, or \"\" for all of them");
    }
    read_numbers(table, "server", config);
    if (config.port != 0 && config.port < config.least_port) {
        table.fail("port", "a number from " + std::to_string(config.least_port) + " to 65535");
    }
    config.host_names = table.texts("host_names");
    for (const std::string& host : config.host_names) {
        if (!is_host(host)) {
            table.fail("host_names", "names and addresses without scheme and port");
        }
    }
    read_announced(table, config);
    config.nodesets = table.texts("nodesets");
    config.nodesets_strict = table.flag("nodesets_strict", config.nodesets_strict);
    if (const auto locales = table.texts("locales"); !locales.empty()) {
        if (!std::all_of(locales.begin(), locales.end(), is_locale)) {
            table.fail("locales", "languages with or without a country: \"en\", \"de-AT\"");
        }
        config.server.locale_ids = locales;
    }
    config.server.is_auditing = table.flag("auditing", config.server.is_auditing);
    auto& limits = config.server.limits;
    limits.min_token_lifetime = std::chrono::milliseconds{table.integer(
        "min_channel_lifetime_ms", limits.min_token_lifetime.count(), 100, 3'600'000)};
    config.key_log = table.text("key_log", "");
#ifndef BUSBAR_KEY_LOG
    if (!config.key_log.empty()) {
        table.fail("key_log", "nothing: this build does not export its keys");
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

void read_discovery(const TomlTable& table, ControllerConfig& all)
{
    table.allow({"url", "interval_s", "allow_none", "server"});
    read_numbers(table, "discovery", all);
    DiscoveryConfig& config = all.discovery;
    config.url = table.text("url", "");
    if (!config.url.empty() && !channel::EndpointUrl::parse(config.url)) {
        table.fail("url", "opc.tcp://host:port of the discovery server");
    }
    config.allows_none = table.flag("allow_none", false);
}

/// Reads the servers that FindServersOnNetwork returns (Part 4, 5.5.3).
std::vector<server::NetworkServer> read_network_servers(const TomlTable& table)
{
    constexpr std::size_t most = 1'000;
    constexpr std::size_t longest_name = 63; // Part 12, 4.3.4
    std::vector<server::NetworkServer> servers;
    for (const TomlTable& entry : table.tables("server")) {
        entry.allow({"name", "url", "capabilities"});
        server::NetworkServer server{entry.text("name"), entry.text("url"),
                                     entry.texts("capabilities")};
        if (server.name.empty() || server.name.size() > longest_name) {
            entry.fail("name", "a name of 1 to 63 bytes");
        }
        if (!channel::EndpointUrl::parse(server.discovery_url)) {
            entry.fail("url", "opc.tcp://host:port of the server");
        }
        if (servers.size() == most) {
            entry.fail("name", "no more than 1,000 servers");
        }
        servers.push_back(std::move(server));
    }
    return servers;
}

ControllerConfig read_root(const TomlTable& root)
{
    root.allow({"server", "reverse_connect", "discovery", "certificates", "endpoint", "security",
                "users", "files", "limits", "machine", "labels", "plc", "backend"});
    ControllerConfig config;
    config.machine.types = default_types();
    read_preset(root, config);
    read_server(root.table("server"), config);
    read_reverse_connect(root.table("reverse_connect"), config);
    read_discovery(root.table("discovery"), config);
    config.server.network_servers = read_network_servers(root.table("discovery"));
    read_certificates(root.table("certificates"), config);
    config.files = read_files(root, config.certificates);
    read_limits(root, config);
    read_users(root.table("users"), config);
    read_endpoints(root, config);
    read_machine(root.table("machine"), config);
    read_labels(root.table("labels"), config);
    read_plc_of_program(root.table("plc"), config);
    config.backends = read_backends(root);
    check_files(root, config);
    check_memory(root.table("limits"), config);
    return config;
}

} // namespace

bool has_account(const UserConfig& users, const std::string& name)
{
    return std::any_of(users.accounts.begin(), users.accounts.end(),
                       [&](const Account& account) { return account.name == name; });
}

bool is_nobody(const UserConfig& users)
{
    return !users.anonymous && !users.certified && users.accounts.empty() && !users.tokens;
}

toml::table parse_table(std::string_view text, const std::string& file)
{
    auto table = parse_toml(text);
    if (!table) {
        throw ConfigError{file + ":" + std::to_string(table.error().line), table.error().text};
    }
    return std::move(*table);
}

ControllerConfig config_of(const toml::table& table, const std::string& file, SourceFiles& sources)
{
    return read_root(TomlTable{table, file, sources});
}

std::string certificate_folder(const toml::table& table)
{
    return table["certificates"]["folder"].value_or(CertificateConfig{}.folder);
}

ControllerConfig parse_config(std::string_view text, const std::string& file)
{
    SourceFiles sources;
    return config_of(parse_table(text, file), file, sources);
}

std::string read_config_text(const std::string& path, SourceFiles& sources)
{
    if (path.empty()) {
        return default_config;
    }
    auto text = sources.text(path, max_config_size);
    if (!text) {
        Problem problem = std::move(text).error();
        if (problem.status == status::Bad_EncodingLimitsExceeded) {
            problem.text += ", expected a configuration";
        }
        if (problem.status != status::Bad_NotFound) {
            problem.text += "; --print-config prints one";
        }
        throw ConfigError{problem.where, problem.text};
    }
    return **text;
}

ControllerConfig read_config(const std::string& path)
{
    SourceFiles sources;
    const std::string text = read_config_text(path, sources);
    return config_of(parse_table(text, path), path, sources);
}

ControllerConfig read_config_or_default(const std::string& path)
{
    return path.empty() ? parse_config(default_config, "built-in") : read_config(path);
}

} // namespace busbar::product
