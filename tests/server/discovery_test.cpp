#include <catch2/catch.hpp>

#include <busbar/server/running_server.hpp>
#include <busbar/types/discovery.hpp>

#include "support/server_fixture.hpp"

namespace discovery_test {

using namespace busbar;
using namespace busbar::test;

namespace {

constexpr const char* binary_profile =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";

Array<EndpointDescription> endpoints(TestClient& client, const char* url)
{
    GetEndpointsRequest request;
    request.endpoint_url = url;
    const auto response = client.call<GetEndpointsResponse>(request);
    return response ? response->endpoints : Array<EndpointDescription>{};
}

} // namespace

TEST_CASE("the endpoints are described in full", "[unit:Discovery Get Endpoints]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    const auto found = endpoints(client, "opc.tcp://localhost:4840");
    REQUIRE(found.size() == 3);
    for (const EndpointDescription& endpoint : found) {
        CHECK(endpoint.endpoint_url == String{"opc.tcp://localhost:4840"});
        CHECK(endpoint.server.application_uri == String{"urn:busbar:test:server"});
        CHECK(endpoint.server.application_type == ApplicationType::Server);
        CHECK(endpoint.server.discovery_urls.size() == 1);
        CHECK(endpoint.transport_profile_uri == String{binary_profile});
        CHECK(endpoint.server_certificate ==
              ByteString{server_identity().certificates.front().der()});
    }
    CHECK(found[0].security_mode == MessageSecurityMode::SignAndEncrypt);
    CHECK(found[1].security_mode == MessageSecurityMode::Sign);
    CHECK(found[2].security_mode == MessageSecurityMode::None);
    CHECK(found[0].security_level > found[1].security_level);
    CHECK(found[2].security_level == 0);
    REQUIRE(found[0].user_identity_tokens.size() == 1);
    REQUIRE(found[2].user_identity_tokens.size() == 2);
    CHECK(found[2].user_identity_tokens[0].token_type == UserTokenType::Anonymous);
    // Passwords are encrypted although the channel is not.
    CHECK(found[2].user_identity_tokens[1].security_policy_uri ==
          String{"http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256"});
}

TEST_CASE("the URL has the host that the client used, if it is one of the server's")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    const auto [asked, told] = GENERATE(table<const char*, const char*>({
        {"opc.tcp://plc.example:4840/x", "opc.tcp://plc.example:4840"},
        {"OPC.TCP://PLC.Example", "opc.tcp://PLC.Example:4840"},
        {"opc.tcp://evil.example:4840", "opc.tcp://localhost:4840"},
        {"opc.tcp://[::1", "opc.tcp://localhost:4840"},
        {"http://plc.example", "opc.tcp://localhost:4840"},
        {"", "opc.tcp://localhost:4840"},
    }));
    const auto found = endpoints(client, asked);
    REQUIRE(found.size() == 3);
    CHECK(found[0].endpoint_url == String{told});
    CHECK(found[0].server.discovery_urls[0] == String{told});
}

TEST_CASE("the URL is that of the listener that the client used, if it is one of the server's")
{
    auto config = ServerFixture::insecure_config();
    config.further_urls = {"opc.tcp://192.0.2.9:4841", "opc.tcp://192.0.2.9:4842"};
    ServerFixture fixture{std::move(config)};
    auto client = fixture.connect();
    const auto [asked, told] = GENERATE(table<const char*, const char*>({
        {"opc.tcp://192.0.2.9:4841", "opc.tcp://192.0.2.9:4841"},
        {"opc.tcp://192.0.2.9:4842/x", "opc.tcp://192.0.2.9:4842"},
        {"opc.tcp://192.0.2.9:4843", "opc.tcp://localhost:4840"},
        {"opc.tcp://plc.example:4841", "opc.tcp://plc.example:4840"},
    }));
    const auto found = endpoints(client, asked);
    REQUIRE(found.size() == 3);
    CHECK(found[0].endpoint_url == String{told});

    auto wrong = fixture.server.config();
    wrong.further_urls = {"192.0.2.9"};
    const auto refused = server::RunningServer{fixture.server}.reconfigure(wrong);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().where == "further_urls");
}

TEST_CASE("only endpoints of the transport profiles that are asked for",
          "[unit:Discovery Get Endpoints]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    GetEndpointsRequest request;
    request.profile_uris = {"http://opcfoundation.org/UA-Profile/Transport/https-uabinary"};
    CHECK(client.call<GetEndpointsResponse>(request)->endpoints.empty());
    request.profile_uris.push_back(binary_profile);
    CHECK(client.call<GetEndpointsResponse>(request)->endpoints.size() == 3);
}

TEST_CASE("FindServers finds this server", "[unit:Discovery Find Servers Self]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    FindServersRequest request;
    request.endpoint_url = "opc.tcp://plc.example:4840";
    auto found = client.call<FindServersResponse>(request);
    REQUIRE(found);
    REQUIRE(found->servers.size() == 1);
    CHECK(found->servers[0].discovery_urls[0] == String{"opc.tcp://plc.example:4840"});
    request.server_uris = {"urn:other"};
    CHECK(client.call<FindServersResponse>(request)->servers.empty());
    request.server_uris.push_back("urn:busbar:test:server");
    CHECK(client.call<FindServersResponse>(request)->servers.size() == 1);
}

TEST_CASE("a server without open endpoints can still be discovered, unless that is off too")
{
    auto config = ServerFixture::secure_config();
    config.has_open_discovery = GENERATE(true, false);
    const bool expected = config.has_open_discovery;
    ServerFixture fixture{std::move(config)};
    auto client = fixture.connect();
    CHECK(endpoints(client, "opc.tcp://localhost:4840").size() == (expected ? 2U : 0U));
    CHECK(client.is_closed() == !expected);
}

TEST_CASE("FindServersOnNetwork tells of the servers of the configuration (Part 4, 5.5.3)")
{
    auto config = ServerFixture::insecure_config();
    for (const char* name : {"press", "robot", "oven"}) {
        config.network_servers.push_back(
            {name, std::string{"opc.tcp://"} + name + ":4840", {"DA"}});
    }
    config.network_servers[1].capabilities = {"DA", "HD"};
    ServerFixture fixture{std::move(config)};
    auto client = fixture.connect();
    const auto records = [&](std::uint32_t after, std::uint32_t most, Array<String> wanted) {
        FindServersOnNetworkRequest request;
        request.starting_record_id = after;
        request.max_records_to_return = most;
        request.server_capability_filter = std::move(wanted);
        const auto response = client.call<FindServersOnNetworkResponse>(request);
        REQUIRE(response);
        CHECK(response->last_counter_reset_time == today);
        std::vector<std::uint32_t> ids;
        for (const ServerOnNetwork& server : response->servers) {
            ids.push_back(server.record_id);
        }
        return ids;
    };
    using Ids = std::vector<std::uint32_t>;
    CHECK(records(0, 0, {}) == Ids{1, 2, 3});
    CHECK(records(1, 0, {}) == Ids{2, 3});
    CHECK(records(1, 1, {}) == Ids{2});
    CHECK(records(3, 0, {}) == Ids{});
    CHECK(records(UINT32_MAX, UINT32_MAX, {}) == Ids{});
    CHECK(records(0, 0, {"hd", "da"}) == Ids{2});
    CHECK(records(0, 0, {"LDS"}) == Ids{});
    FindServersOnNetworkRequest long_filter;
    for (int i = 0; i < 101; ++i) {
        long_filter.server_capability_filter.push_back("DA");
    }
    CHECK(client.status_of<FindServersOnNetworkResponse>(long_filter) ==
          status::Bad_InvalidArgument);
}

TEST_CASE("FindServersOnNetwork is not there where no servers are configured")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    CHECK(client.status_of<FindServersOnNetworkResponse>(FindServersOnNetworkRequest{}) ==
          status::Bad_ServiceUnsupported);
}

} // namespace discovery_test
