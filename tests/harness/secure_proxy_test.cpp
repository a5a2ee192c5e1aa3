#include <busbar/harness/secure_proxy.hpp>

#include <algorithm>
#include <map>

#include <catch2/catch.hpp>

#include <busbar/crypto/security_policy.hpp>
#include <busbar/harness/bench.hpp>
#include <busbar/harness/catch.hpp>
#include <busbar/harness/client_host.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/harness/scripted_client.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/discovery.hpp>

namespace secure_proxy_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

constexpr const char* server_url = "opc.tcp://server:4840/machine";
constexpr const char* proxy_url = "opc.tcp://proxy:4841";
const std::string password = "a secret of the operator";

const channel::ApplicationIdentity& identity(const std::string& name)
{
    static std::map<std::string, channel::ApplicationIdentity> made;
    auto found = made.find(name);
    if (found == made.end()) {
        IdentityOptions options;
        options.name = name;
        found = made.emplace(name, make_identity(options).value()).first;
    }
    return found->second;
}

channel::SecuritySetting secured(MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt)
{
    return {crypto::find_policy_by_name("Basic256Sha256"), mode};
}

/// Accepts one certificate, as a trust list with one entry does.
class OnlyOne final : public crypto::CertificateValidator {
public:
    explicit OnlyOne(const std::string& name) : name_{name} {}

    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext&) override
    {
        if (chain.front() == identity(name_).certificates.front()) {
            return {};
        }
        return busbar::refuse(
            {status::Bad_CertificateUntrusted, "Trust List Check", "another one", "", ""});
    }

    void become(const std::string& name) { name_ = name; }

private:
    std::string name_;
};

Array<EndpointDescription> endpoints_at(World& world, const char* url)
{
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = url;
    config.wants_session = false;
    ConnectionHost client{world, config};
    need(client.open());
    GetEndpointsRequest request;
    request.endpoint_url = url;
    auto response = need(client.call<GetEndpointsResponse>(request));
    client.close();
    return std::move(response.endpoints);
}

/// A server that knows the proxy only, the proxy, and a client that knows the proxy only.
struct Site {
    explicit Site(const std::vector<MessageSecurityMode>& modes = {
                      MessageSecurityMode::None, MessageSecurityMode::Sign,
                      MessageSecurityMode::SignAndEncrypt})
    {
        users.add("operator", password);
        server::ServerConfig config = open_server_config();
        config.endpoint_url = server_url;
        config.application_uri = "urn:busbar:harness:server";
        config.identity = identity("server");
        config.endpoints.clear();
        for (const MessageSecurityMode mode : modes) {
            server::EndpointConfig& endpoint = config.endpoints.emplace_back();
            endpoint.security =
                mode == MessageSecurityMode::None ? channel::SecuritySetting{} : secured(mode);
            endpoint.allows_anonymous = true;
        }
        ServerParts server_parts;
        server_parts.validator = &knows_proxy;
        server_parts.users = &users;
        server.emplace(world, config, server_parts);
        REQUIRE(server->is_running());
        SecureProxyParts parts;
        parts.identity = &identity("proxy");
        parts.client_validator = &knows_client;
        parts.server_validator = &knows_server;
        proxy.emplace(world, proxy_url, server_url, endpoints_at(world, server_url), parts);
        REQUIRE(proxy->is_listening());
        world.network().set_observer(recorder);
    }
    /// A client that finds out by itself what the proxy offers.
    client::ClientConfig client_config(MessageSecurityMode mode, client::UserIdentity user) const
    {
        client::ClientConfig config = open_client_config();
        config.endpoint_url = proxy_url;
        config.application_uri = "urn:busbar:harness:client";
        config.identity = std::move(user);
        config.security.allows_none = mode == MessageSecurityMode::None;
        config.security.min_mode =
            mode == MessageSecurityMode::None ? MessageSecurityMode::Sign : mode;
        config.reconnect.is_enabled = false;
        return config;
    }
    ClientParts client_parts(const std::string& name = "client")
    {
        ClientParts parts;
        parts.identity = &identity(name);
        parts.validator = &knows_proxy;
        return parts;
    }
    [[nodiscard]] std::vector<std::string> names() const
    {
        std::vector<std::string> names;
        for (const RecordedMessage& message : read_messages(recorder->recording())) {
            names.push_back(message.name);
        }
        return names;
    }

    World world;
    TestUsers users;
    OnlyOne knows_proxy{"proxy"};
    OnlyOne knows_client{"client"};
    OnlyOne knows_server{"server"};
    std::optional<ServerHost> server;
    std::optional<SecureProxy> proxy;
    std::shared_ptr<Recorder> recorder{std::make_shared<Recorder>(1)};
};

ReadRequest read_state()
{
    ReadRequest request;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = NodeId{0, 2259};
    item.attribute_id = 13;
    return request;
}

/// A client that does what no proper one does, with an open channel.
std::unique_ptr<ScriptedClient> scripted(Site& site, const std::string& name)
{
    site.knows_client.become(name);
    channel::ClientChannelConfig config;
    config.endpoint_url = proxy_url;
    config.security = secured();
    config.server_certificate = identity("proxy").certificates.front();
    auto client = std::make_unique<ScriptedClient>(site.world, config, site.client_parts(name));
    need(client->open());
    return client;
}

StatusCode created(ScriptedClient& client, const std::string& certificate, const std::string& uri)
{
    CreateSessionRequest request;
    request.endpoint_url = String{proxy_url};
    request.client_description.application_uri = String{uri};
    request.client_certificate = ByteString{identity(certificate).certificates.front().der()};
    request.client_nonce = ByteString{std::vector<std::byte>(32, std::byte{7})};
    need(client.send(request));
    const auto response = client.expect<CreateSessionResponse>();
    return response ? StatusCode{} : response.error();
}

bool contains(const std::vector<std::string>& names, const std::string& name)
{
    return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

TEST_CASE("a proxy that both sides trust reads what they say with security", "[harness]")
{
    const auto mode = GENERATE(MessageSecurityMode::None, MessageSecurityMode::Sign,
                               MessageSecurityMode::SignAndEncrypt);
    Site site{{mode}};
    const bool is_named = GENERATE(false, true);
    INFO(static_cast<int>(mode) << " " << is_named);
    const client::UserIdentity user =
        is_named ? client::UserIdentity{client::NamedUser{"operator", password}}
                 : client::UserIdentity{client::AnonymousUser{}};
    client::ClientConfig config = site.client_config(mode, user);
    if (mode == MessageSecurityMode::None) {
        config.security.policies = {"None"};
    }
    ClientHost client{site.world, config, site.client_parts()};
    REQUIRE(client.connect());
    // Another mode than the client's would be no test of the server's channel.
    CHECK(client.client().endpoint()->security_mode == mode);
    const auto read = client.call<ReadResponse>(read_state());
    REQUIRE(read);
    CHECK(read->results[0].value == Variant{std::int32_t{0}});
    client.close();

    const auto names = site.names();
    CHECK(contains(names, "GetEndpointsResponse"));
    CHECK(contains(names, "CreateSessionRequest"));
    CHECK(contains(names, "ReadRequest"));
    CHECK(contains(names, "ReadResponse"));
    // The password is in no byte of the recording, and not in the log.
    CHECK(write_recording(site.recorder->recording()).find("612073656372657420") ==
          std::string::npos);
    CHECK(site.world.log().text().find(password) == std::string::npos);
}

TEST_CASE("the endpoints of a proxy are those of the server, but for its own names", "[harness]")
{
    Site site;
    const auto endpoints = endpoints_at(site.world, proxy_url);
    REQUIRE(endpoints.size() == 3);
    for (const EndpointDescription& endpoint : endpoints) {
        CHECK(endpoint.endpoint_url == String{"opc.tcp://proxy:4841/machine"});
        CHECK(endpoint.server.application_uri == String{"urn:busbar:harness:proxy"});
        CHECK(endpoint.server_certificate ==
              ByteString{identity("proxy").certificates.front().der()});
    }
}

TEST_CASE("faults by field act on secured messages through a proxy", "[harness]")
{
    Site site;
    site.world.network().play(
        parse_fault("edit results[0].value = Double:9 at ReadResponse 2").value());
    site.world.network().play(parse_fault("answer Bad_Timeout at ReadRequest 3").value());
    site.world.network().play(parse_fault("duplicate at ReadRequest 4").value());
    ClientHost client{
        site.world,
        site.client_config(MessageSecurityMode::SignAndEncrypt, client::AnonymousUser{}),
        site.client_parts()};
    REQUIRE(client.connect());
    std::vector<Variant> values;
    for (int i = 0; i < 6; ++i) {
        const auto read = client.call<ReadResponse>(read_state());
        values.push_back(read ? read->results[0].value : Variant{String{text_of(read.error())}});
    }
    INFO(site.world.account());
    // The client reads the namespaces and the like before.
    CHECK(std::count(values.begin(), values.end(), Variant{9.0}) +
              std::count(values.begin(), values.end(), Variant{std::int32_t{0}}) >=
          4);
    CHECK(site.world.network().pending_faults().empty());
}

TEST_CASE("a proxy refuses a wrong password as the server does", "[harness]")
{
    Site site;
    ClientHost client{site.world,
                      site.client_config(MessageSecurityMode::SignAndEncrypt,
                                         client::NamedUser{"operator", "wrong"}),
                      site.client_parts()};
    const auto connected = client.connect();
    REQUIRE_FALSE(connected);
    CHECK(connected.error() == status::Bad_UserAccessDenied);
    CHECK(contains(site.names(), "ActivateSessionRequest"));
}

TEST_CASE("a proxy cannot forward the certificate of a user, and says so", "[harness]")
{
    // The server has to offer it first.
    World world;
    ScriptedServerParts server_parts;
    server_parts.allowed = {{}, secured()};
    server_parts.identity = &identity("server");
    ScriptedServer server{world, server_url, server_parts};
    server.accept_clients();
    auto endpoints = endpoints_at(world, server_url);
    for (EndpointDescription& endpoint : endpoints) {
        UserTokenPolicy& policy = endpoint.user_identity_tokens.emplace_back();
        policy.policy_id = "certificate";
        policy.token_type = UserTokenType::Certificate;
    }
    SecureProxyParts parts;
    parts.identity = &identity("proxy");
    SecureProxy proxy{world, proxy_url, server_url, endpoints, parts};
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = proxy_url;
    config.channel.security = secured();
    config.channel.server_certificate = identity("proxy").certificates.front();
    config.token_policy =
        endpoints[1].user_identity_tokens[endpoints[1].user_identity_tokens.size() - 1];
    config.identity =
        client::CertificateUser{identity("user").certificates.front(),
                                std::make_shared<const crypto::PrivateKey>(identity("user").key)};
    ClientParts client_parts;
    client_parts.identity = &identity("client");
    ConnectionHost client{world, config, client_parts};
    const auto opened = client.open();
    REQUIRE_FALSE(opened);
    CHECK(opened.error() == status::Bad_IdentityTokenRejected);
    CHECK(world.log().text().find("cannot sign for the server") != std::string::npos);
    const auto& came = server.came();
    CHECK(std::find(came.begin(), came.end(), "ActivateSessionRequest") == came.end());
}

TEST_CASE("a proxy turns away clients and servers that it does not trust", "[harness]")
{
    Site site;
    SECTION("a client")
    {
        ClientHost client{
            site.world,
            site.client_config(MessageSecurityMode::SignAndEncrypt, client::AnonymousUser{}),
            site.client_parts("stranger")};
        CHECK_FALSE(client.connect());
    }
    SECTION("a server")
    {
        site.knows_server.become("elsewhere");
        ClientHost client{
            site.world,
            site.client_config(MessageSecurityMode::SignAndEncrypt, client::AnonymousUser{}),
            site.client_parts()};
        CHECK_FALSE(client.connect());
    }
    CHECK(site.world.log().text().find("Trust List Check failed") != std::string::npos);
    CHECK_FALSE(contains(site.names(), "CreateSessionResponse"));
}

TEST_CASE("what cuts the connection in a proxy cuts it for both sides", "[harness]")
{
    Site site;
    site.world.network().play(fault::cut().after(Message{"CreateSessionResponse"}));
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = proxy_url;
    config.channel.security = secured();
    config.channel.server_certificate = identity("proxy").certificates.front();
    ConnectionHost client{site.world, config, site.client_parts()};
    CHECK_FALSE(client.open());
    CHECK(site.world.network().pending_faults().empty());
    site.world.run_for(1s);
    CHECK(site.server->server().connection_count() == 0);
}

TEST_CASE("a proxy compares the client of a session with that of its channel", "[harness]")
{
    Site site;
    const auto client = scripted(site, "client");
    CHECK(created(*client, "stranger", "urn:busbar:harness:stranger") ==
          status::Bad_SecurityChecksFailed);
    CHECK(created(*client, "client", "urn:busbar:harness:stranger") ==
          status::Bad_CertificateUriInvalid);
    CHECK_FALSE(contains(site.names(), "CreateSessionRequest"));
    CHECK(created(*client, "client", "urn:busbar:harness:client") == StatusCode{});
}

TEST_CASE("a session behind a proxy does not move to another client", "[harness]")
{
    Site site;
    const auto client = scripted(site, "client");
    REQUIRE(client->open_session());
    const auto thief = scripted(site, "stranger");
    ActivateSessionRequest request;
    request.request_header.authentication_token = client->authentication_token();
    need(thief->send(request));
    const auto moved = thief->expect<ActivateSessionResponse>();
    REQUIRE_FALSE(moved);
    CHECK(moved.error() == status::Bad_SecurityChecksFailed);
}

TEST_CASE("a proxy refuses a login in which it cannot look for a password", "[harness]")
{
    Site site;
    const auto client = scripted(site, "client");
    ActivateSessionRequest request;
    // A session that the proxy does not know, whose signature it does not check.
    request.request_header.authentication_token = NodeId{1, 7};
    request.user_identity_token =
        ExtensionObject::from_binary(NodeId{1, 7}, ByteString{std::as_bytes(std::span{password})});
    need(client->send(request));
    const auto activated = client->expect<ActivateSessionResponse>();
    REQUIRE_FALSE(activated);
    CHECK(activated.error() == status::Bad_IdentityTokenInvalid);
    need(client->send(request, {.cut_off = 3}));
    const auto cut = client->expect<ActivateSessionResponse>();
    REQUIRE_FALSE(cut);
    CHECK(cut.error() == status::Bad_DecodingError);
    CHECK_FALSE(contains(site.names(), "ActivateSessionRequest"));
}

TEST_CASE("a connection outside of the network uses up no fault if nothing listens", "[harness]")
{
    Site site;
    site.proxy.reset();
    site.world.network().play(parse_fault("refuse times 1").value());
    ClientHost client{
        site.world,
        site.client_config(MessageSecurityMode::SignAndEncrypt, client::AnonymousUser{}),
        site.client_parts()};
    CHECK_FALSE(client.connect(20s));
    CHECK_FALSE(site.world.network().pending_faults().empty());
    site.world.network().forgive_pending_faults();
}

TEST_CASE("a proxy forgets what it has answered, and goes on", "[harness]")
{
    Site site{{MessageSecurityMode::None}};
    site.world.network().set_observer(nullptr);
    // The proxy remembers 4,096 exchanges, in case that a response comes twice.
    site.world.network().play(parse_fault("duplicate at ReadResponse 4150").value());
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = proxy_url;
    ConnectionHost client{site.world, config, site.client_parts()};
    need(client.open());
    int good = 0;
    for (int i = 0; i < 4'200; ++i) {
        const auto read = client.call<ReadResponse>(read_state());
        good += read && read->results[0].value == Variant{std::int32_t{0}} ? 1 : 0;
    }
    CHECK(good == 4'200);
    CHECK(site.world.network().pending_faults().empty());
}

TEST_CASE("a client of a proxy learns that the server is not there", "[harness]")
{
    Site site;
    site.server.reset();
    ClientHost client{
        site.world,
        site.client_config(MessageSecurityMode::SignAndEncrypt, client::AnonymousUser{}),
        site.client_parts()};
    CHECK_FALSE(client.connect(20s));
}

} // namespace secure_proxy_test
