#include "welcome.hpp"

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/crypto/certificate_notices.hpp>

namespace busbar::product {

namespace {

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
