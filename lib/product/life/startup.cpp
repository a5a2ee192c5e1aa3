#include "startup.hpp"

#include <cstdio>
#include <string>
#include <utility>

#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/crypto/certificate_notices.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/system.hpp>

#include "product/access/identity.hpp"
#include "product/access/setup.hpp"
#include "product/configuration/addresses.hpp"
#include "product/machine/lookout.hpp"
#include "product/printing/describe.hpp"

namespace busbar::product {

namespace {

bool needs_certificate(const ControllerConfig& config)
{
    if (!config.discovery.url.empty() && !config.discovery.allows_none) {
        return true;
    }
    for (const server::EndpointConfig& endpoint : config.server.endpoints) {
        if (!endpoint.security.policy->is_none() || endpoint.allows_user_name ||
            endpoint.allows_certificate || endpoint.allows_issued) {
            return true;
        }
    }
    return false;
}

std::string hosts_text(const server::ServerConfig& server)
{
    const auto url = channel::EndpointUrl::parse(server.endpoint_url);
    std::string text;
    for (const std::string& host : server.host_names) {
        if (!url || !channel::is_same_host(url->host, host)) {
            text += (text.empty() ? "  clients may also use: " : ", ") + host;
        }
    }
    return text.empty() ? text : text + "\n";
}

std::string endpoint_text(const server::EndpointConfig& endpoint)
{
    return "  endpoint: " + std::string{endpoint.security.policy->name} + " " +
           std::string{channel::name(endpoint.security.mode)} +
           (endpoint.allows_anonymous ? ", anonymous" : "") +
           (endpoint.allows_user_name ? ", user name" : "") +
           (endpoint.allows_certificate ? ", user certificate" : "") +
           (endpoint.allows_issued ? ", issued token" : "") + "\n";
}

std::string certificate_lines(const ControllerConfig& config, DateTime now)
{
    const crypto::Certificate& own = config.server.identity->certificates.front();
    std::string text = "  certificate: " + own.thumbprint_text() + "\n";
    for (const auto& notice : crypto::certificate_notices(own, now, config.server.host_names)) {
        if (notice.kind == crypto::CertificateNotice::Kind::HostNotNamed) {
            text += "  " + notice.text + "; --regenerate-certificate does\n";
        }
    }
    const std::string& folder = config.certificates.folder;
    return text + (config.certificates.trusts_all_clients
                       ? "  every client is trusted: not for use in production\n"
                       : "  clients: move a certificate from " + folder + "/rejected/certs to " +
                             folder + "/trusted/certs\n");
}

/// Tells whether the task of the PLC starts in time, or how to achieve that.
std::string task_text(const ControllerConfig& config, std::optional<int> granted)
{
    if (!granted) {
        return "";
    }
    if (*granted != 0) {
        return "  plc: the task runs at real-time priority " + std::to_string(*granted) + "\n";
    }
    const std::string ordinary = "  plc: the task runs at ordinary priority, ahead of the server; ";
    if (config.realtime_priority == 0) {
        return ordinary + "raise it by realtime_priority in [plc]\n";
    }
    const std::string wanted = std::to_string(config.realtime_priority);
    return ordinary + "raise it by CAP_SYS_NICE or LimitRTPRIO=" + wanted + "\n";
}

} // namespace

void set_names(ControllerConfig& config)
{
    const std::string machine = machine_name();
    server::ServerConfig& server = config.server;
    if (server.application_uri.empty()) {
        server.application_uri = "urn:" + machine + ":busbar:controller";
    }
    server::BuildDescription& build = server.build;
    if (build.manufacturer_name.empty()) {
        build.manufacturer_name = "Busbar";
    }
    if (build.software_version.empty()) {
        build.software_version = BUSBAR_VERSION;
    }
    build.build_number = BUSBAR_VERSION;
    build.build_date = parse_date_time(BUSBAR_BUILD_DATE "T00:00:00Z").value_or(DateTime{});
    server.program = program_of(config, net::is_clock_synchronized());
    server.host_names = present_hosts(config);
}

void make_missing_certificate(ControllerConfig config, DateTime now, LogSink& log)
{
    if (needs_certificate(config)) {
        set_names(config);
        static_cast<void>(load_identity(config.certificates, config.server.application_name,
                                        config.server.application_uri, config.server.host_names,
                                        now, log));
    }
}

void set_endpoint(ControllerConfig& config, std::uint16_t port, DateTime now, LogSink& log)
{
    server::ServerConfig& server = config.server;
    channel::EndpointUrl url;
    url.host = default_host(config, machine_name());
    constexpr std::uint16_t usual_port = 4840;
    url.port = port != 0 ? port : usual_port; // the server is not used, and its port is any
    server.endpoint_url = url.text();
    if (needs_certificate(config)) {
        server.identity = load_identity(config.certificates, server.application_name,
                                        server.application_uri, server.host_names, now, log);
    }
}

void add_first_account(ControllerConfig& config)
{
    const std::string& folder = config.certificates.folder;
    auto first = load_first_account(folder);
    if (!first && ::isatty(STDOUT_FILENO) == 0) {
        throw ConfigError{
            folder, "no user can log in yet, expected a first start on a terminal, which shows "
                    "a password once, or an account in a file: see --print-config"};
    }
    if (!first) {
        crypto::SystemRandom random;
        first = make_first_account(folder, random, config.users.password_rules.cost);
        std::printf("user \"%s\", password \"%.*s\": shown this once; %s/operator.password has its "
                    "hash\n",
                    first->account.name.c_str(), static_cast<int>(first->password->size()),
                    first->password->text().data(), folder.c_str());
    }
    config.users.accounts.push_back(first->account);
    offer_users(config);
}

Reading read(const Configuration& configuration, Substitutes substitutes)
{
    Reading reading = read_sources(configuration, std::move(substitutes));
    ControllerConfig& config = reading.config;
    if (configuration.file.empty()) {
        add_first_account(config);
    } else if (is_nobody(config.users) && !config.users.has_setup) {
        throw ConfigError{configuration.file,
                          "no user can log in, expected an account, anonymous, "
                          "certificates or tokens in [users]: see --print-config"};
    }
    return reading;
}

std::string setup_text(const std::string& url)
{
    return "  1. busbar admin setup " + url +
           " chief --user setup\n"
           "     shows the controller's certificate, whose thumbprint is the one below, and asks "
           "for "
           "the code and for a password\n"
           "  2. busbar watch " +
           url +
           " --user chief\n"
           "     the administrator chief reads and writes; this busbar is trusted from now on\n"
           "  3. other clients: let them connect once, which is refused, and trust them:\n"
           "     busbar admin trust list " +
           url + " --user chief, then trust move THUMBPRINT\n";
}

std::string welcome_text(const ControllerConfig& config, std::size_t variables, DateTime now,
                         std::optional<int> task_priority)
{
    const server::ServerConfig& server = config.server;
    if (!config.machine.is_used) {
        return server.application_name + " with " + std::to_string(variables) +
               " variables and no port: use = false in [machine]\n" +
               task_text(config, task_priority) + "ready; stop with Ctrl+C\n";
    }
    std::string text = server.application_name + " with " + std::to_string(variables) +
                       " variables at " + server.endpoint_url + "\n" + hosts_text(server);
    for (const server::EndpointConfig& endpoint : server.endpoints) {
        text += endpoint_text(endpoint);
    }
    for (const std::string& url : config.reverse_urls) {
        text += "  connects to the client at " + url + "\n";
    }
    if (!config.discovery.url.empty()) {
        text += "  registers with the discovery server at " + config.discovery.url + "\n";
    }
    if (server.identity) {
        text += certificate_lines(config, now);
    }
    return text + task_text(config, task_priority) + "ready; stop with Ctrl+C\n";
}

} // namespace busbar::product
