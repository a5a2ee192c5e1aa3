#pragma once

#include <catch2/catch.hpp>

#include <string>
#include <utility>

#include <busbar/client/registration.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/harness/discovery_server.hpp>

namespace busbar::test {

inline constexpr const char* discovery_url = "opc.tcp://discovery:4840/UADiscovery";
inline constexpr const char* server_uri = "urn:busbar:harness:press";

inline client::RegistrationSettings press()
{
    client::RegistrationSettings settings;
    RegisteredServer& server = settings.server;
    server.server_uri = server_uri;
    server.product_uri = "urn:busbar";
    server.server_names.push_back(LocalizedText{String{"en"}, String{"Press"}});
    server.server_names.push_back(LocalizedText{String{"de"}, String{"Presse"}});
    server.discovery_urls.push_back(String{"opc.tcp://press:4840"});
    settings.mdns.server_capabilities.push_back(String{"DA"});
    settings.interval = std::chrono::minutes{5};
    return settings;
}

inline client::SecurityWishes open_wishes()
{
    client::SecurityWishes wishes;
    wishes.allows_none = true;
    return wishes;
}

/// Without security, for which there is nobody's certificate.
inline client::ClientConfig open_client()
{
    return client::registration_client(discovery_url, open_wishes(), server_uri, false);
}

inline client::ConnectionConfig discovery_connection()
{
    client::ConnectionConfig config = harness::open_connection_config();
    config.channel.endpoint_url = discovery_url;
    config.wants_session = false;
    return config;
}

/// What a client is told that looks for servers, by their names.
inline std::string found_servers(harness::World& world, FindServersRequest request = {})
{
    harness::ConnectionHost client{world, discovery_connection()};
    REQUIRE(client.open());
    const auto response = client.call<FindServersResponse>(std::move(request));
    REQUIRE(response);
    std::string names;
    for (const ApplicationDescription& server : response->servers) {
        names += server.application_name.text.str() + ";";
    }
    client.close();
    return names;
}

} // namespace busbar::test
