#include "harness/proxy_messages.hpp"

#include <map>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/message_body.hpp>

namespace proxy_messages_test {

using namespace busbar;
using namespace busbar::harness;
using harness::detail::ProxyChannels;
using harness::detail::ProxyEndpoints;
using harness::detail::ProxyExchange;
using harness::detail::ProxyMessages;

namespace {

const char* const own_uri = "urn:busbar:harness:server";

channel::SecuritySetting secured()
{
    return {crypto::find_policy_by_name("Basic256Sha256"), MessageSecurityMode::SignAndEncrypt};
}

const channel::ApplicationIdentity& identity(const std::string& name)
{
    static std::map<std::string, channel::ApplicationIdentity> made;
    auto found = made.find(name);
    if (found == made.end()) {
        IdentityOptions options;
        options.name = name;
        found = made.emplace(name, need(make_identity(options))).first;
    }
    return found->second;
}

/// An endpoint of the server "server", or of another one.
EndpointDescription endpoint(const char* url, const channel::SecuritySetting& security,
                             const char* name = "server")
{
    EndpointDescription made;
    made.endpoint_url = url;
    made.server.application_uri = String{"urn:busbar:harness:" + std::string{name}};
    made.server.discovery_urls = {String{url}};
    made.server_certificate = ByteString{identity(name).certificates.front().der()};
    made.security_mode = security.mode;
    made.security_policy_uri = security.policy->uri;
    return made;
}

ProxyEndpoints::Config config_of(std::vector<EndpointDescription> endpoints)
{
    ProxyEndpoints::Config config;
    config.proxy_url = "opc.tcp://proxy:4841";
    config.server_url_text = "opc.tcp://server:4840";
    config.server_url = channel::EndpointUrl::parse(config.server_url_text).value();
    config.endpoints = std::move(endpoints);
    config.identity = &identity("proxy");
    return config;
}

/// Sessions of a client over a channel whose certificate is known, without signatures.
struct Sessions {
    explicit Sessions(const char* name)
    {
        channels.client = identity(name).certificates;
        nonce = ByteString{std::vector<std::byte>(32, std::byte{7})};
    }
    void create(ProxyMessages& messages, std::uint32_t token) const
    {
        CreateSessionResponse response;
        response.authentication_token = NodeId{1, token};
        response.server_nonce = nonce;
        auto body = need(encode_body(response));
        need(messages.to_client(channels, {}, body));
    }
    [[nodiscard]] StatusCode activate(ProxyMessages& messages, std::uint32_t token) const
    {
        ActivateSessionRequest request;
        request.request_header.authentication_token = NodeId{1, token};
        ProxyExchange exchange;
        auto body = need(encode_body(request));
        if (const auto passed = messages.from_client(channels, exchange, body); !passed) {
            return passed.error();
        }
        ActivateSessionResponse response;
        response.server_nonce = nonce;
        body = need(encode_body(response));
        need(messages.to_client(channels, exchange, body));
        return {};
    }

    ProxyChannels channels;
    ByteString nonce;
};

} // namespace

TEST_CASE("a proxy forgets the session that was activated longest ago", "[harness]")
{
    World world;
    ProxyMessages messages{config_of({}), world.clock(), world.log()};
    const Sessions owner{"client"};
    const Sessions stranger{"stranger"};
    for (std::uint32_t token = 1; token <= ProxyMessages::max_sessions; ++token) {
        owner.create(messages, token);
    }
    CHECK(stranger.activate(messages, 1) == status::Bad_SecurityChecksFailed);
    CHECK(owner.activate(messages, 1) == StatusCode{}); // so that 2 is the oldest
    owner.create(messages, ProxyMessages::max_sessions + 1);
    CHECK(stranger.activate(messages, 1) == status::Bad_SecurityChecksFailed);
    CHECK(stranger.activate(messages, 3) == status::Bad_SecurityChecksFailed);
    CHECK(stranger.activate(messages, ProxyMessages::max_sessions + 1) ==
          status::Bad_SecurityChecksFailed);
    // It is the server's to refuse now; as it did not, the session is the other client's.
    CHECK(stranger.activate(messages, 2) == StatusCode{});
    CHECK(owner.activate(messages, 2) == status::Bad_SecurityChecksFailed);
    CHECK(stranger.activate(messages, 3) == StatusCode{}); // which made room for 2
}

TEST_CASE("a proxy leaves what concerns other servers as it is", "[harness]")
{
    const EndpointDescription elsewhere =
        endpoint("opc.tcp://other:4840", secured(), "other"); // the same port
    const EndpointDescription other_port = endpoint("opc.tcp://server:4850", secured());
    const EndpointDescription other_transport = endpoint("https://server:443", secured());
    const ProxyEndpoints endpoints{config_of({elsewhere, endpoint("opc.tcp://alias:4840/path", {}),
                                              endpoint("opc.tcp://server:4840", {}), other_port})};
    CHECK(endpoints.server_uri() == String{own_uri});
    CHECK(endpoints.settings() == std::vector{channel::SecuritySetting{}});
    CHECK_FALSE(endpoints.certificate_for(secured()));

    Array<EndpointDescription> answer{elsewhere, endpoint("opc.tcp://alias:4840/path", {}),
                                      other_port, other_transport};
    endpoints.rewrite(answer);
    REQUIRE(answer.size() == 4);
    CHECK(answer[0] == elsewhere);
    CHECK(answer[1].endpoint_url == String{"opc.tcp://proxy:4841/path"});
    CHECK(answer[1].server.application_uri == String{"urn:busbar:harness:proxy"});
    CHECK(answer[1].server.discovery_urls == Array<String>{"opc.tcp://proxy:4841/path"});
    CHECK(answer[1].server_certificate == endpoints.own_chain());
    CHECK(answer[2] == other_port);
    CHECK(answer[3] == other_transport);

    ApplicationDescription other = elsewhere.server;
    endpoints.rewrite(other);
    CHECK(other == elsewhere.server);
}

TEST_CASE("a proxy takes the first endpoint of the server's port for its own", "[harness]")
{
    const ProxyEndpoints endpoints{config_of({endpoint("https://alias:443", secured(), "other"),
                                              endpoint("opc.tcp://alias:4840", secured()),
                                              endpoint("opc.tcp://b:4840", {}, "other")})};
    CHECK(endpoints.server_uri() == String{own_uri});
    CHECK(endpoints.settings() == std::vector{channel::SecuritySetting{}, secured()});
}

TEST_CASE("a proxy leaves out endpoints that it cannot serve", "[harness]")
{
    const ProxyEndpoints endpoints{config_of({endpoint("opc.tcp://server:4840", secured())})};
    EndpointDescription unknown = endpoint("opc.tcp://server:4840", secured());
    unknown.security_policy_uri = "urn:no:policy";
    Array<EndpointDescription> answer{unknown, endpoint("opc.tcp://server:4840", secured())};
    endpoints.rewrite(answer);
    REQUIRE(answer.size() == 1);
    CHECK(answer[0].endpoint_url == String{"opc.tcp://proxy:4841"});
    CHECK(endpoints.settings() == std::vector{channel::SecuritySetting{}, secured()});
}

TEST_CASE("a proxy stands for a server behind a port map, too", "[harness]")
{
    const ProxyEndpoints endpoints{config_of({endpoint("opc.tcp://inside:50000", secured())})};
    CHECK(endpoints.certificate_for(secured()) == identity("server").certificates.front());
    Array<EndpointDescription> answer{endpoint("opc.tcp://inside:50000", secured()),
                                      endpoint("opc.tcp://other:50000", secured(), "other")};
    endpoints.rewrite(answer);
    CHECK(answer[0].endpoint_url == String{"opc.tcp://proxy:4841"});
    CHECK(answer[1].endpoint_url == String{"opc.tcp://other:50000"});
}

} // namespace proxy_messages_test
