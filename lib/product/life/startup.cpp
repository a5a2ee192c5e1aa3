#include "startup.hpp"

#include <cstdio>
#include <string>
#include <utility>

#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/system.hpp>

#include "product/access/first_account.hpp"
#include "product/access/identity.hpp"
#include "product/configuration/addresses.hpp"
#include "product/machine/lookout.hpp"
#include "product/printing/print_conformance.hpp"

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

} // namespace busbar::product
