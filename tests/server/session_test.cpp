#include <catch2/catch.hpp>

#include <limits>
#include <set>

#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "session_use.hpp"
#include "support/server_fixture.hpp"

namespace session_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE("a session is created, activated, used and closed, with every security",
          "[unit:Session Base][unit:Security Policy Required]"
          "[unit:SecurityPolicy Support][unit:Security Encryption Required]"
          "[unit:Security Signing Required]")
{
    ServerFixture fixture;
    const auto security = GENERATE(channel::SecuritySetting{}, sign, encrypt);
    auto client = fixture.connect(security);
    const auto created = client.create_session();
    REQUIRE(created);
    CHECK(created->revised_session_timeout == 60'000);
    CHECK(created->server_nonce.size() == 32);
    CHECK(created->authentication_token.opaque().size() == 32);
    CHECK(created->session_id != created->authentication_token);
    CHECK(created->server_endpoints.size() == 3);
    CHECK(created->server_signature.signature.is_null() == security.policy->is_none());
    CHECK(client.activate(client.is_secure() ? client.user("operator", "operator-secret")
                                             : TestClient::anonymous()) == status::Good);
    CHECK(client.server_nonce != created->server_nonce);
    CHECK(use(client) == status::Good);
    CHECK(client.close_session() == status::Good);
    CHECK(use(client) == status::Bad_SessionIdInvalid);
    CHECK(fixture.server.session_count() == 0);
}

TEST_CASE("the server proves who it is to a client with security")
{
    ServerFixture fixture;
    auto client = fixture.connect(encrypt);
    const auto request = client.create_request();
    const auto created = client.create_session(request);
    REQUIRE(created);
    const auto& certificate = server_identity().certificates.front();
    std::vector<std::byte> text{request.client_certificate.span().begin(),
                                request.client_certificate.span().end()};
    text.insert(text.end(), request.client_nonce.span().begin(), request.client_nonce.span().end());
    CHECK(crypto::asymmetric_verify(*encrypt.policy, certificate, text,
                                    created->server_signature.signature.span()));
    CHECK(created->server_certificate == ByteString{certificate.der()});
}

TEST_CASE("the session timeout is brought into the limits, whatever is asked for")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    const auto [asked, revised] = GENERATE(table<double, double>({
        {0, 10'000},
        {-1, 10'000},
        {20'000.7, 20'000},
        {std::numeric_limits<double>::quiet_NaN(), 10'000},
        {std::numeric_limits<double>::infinity(), 3'600'000},
        {1e308, 3'600'000},
    }));
    auto request = client.create_request();
    request.requested_session_timeout = asked;
    CHECK(client.create_session(request)->revised_session_timeout == revised);
}

TEST_CASE("CreateSession checks nonce, certificate and ApplicationUri")
{
    ServerFixture fixture;
    auto client = fixture.connect(sign);
    auto request = client.create_request();
    SECTION("nonce")
    {
        const auto size = GENERATE(0U, 31U, 129U);
        request.client_nonce = ByteString{std::vector<std::byte>(size)};
        CHECK(client.create_session(request).error() == status::Bad_NonceInvalid);
    }
    SECTION("another's certificate")
    {
        request.client_certificate = ByteString{server_identity().certificates.front().der()};
        CHECK(client.create_session(request).error() == status::Bad_SecurityChecksFailed);
    }
    SECTION("no certificate")
    {
        request.client_certificate = {};
        CHECK(client.create_session(request).error() == status::Bad_SecurityChecksFailed);
    }
    SECTION("more behind the certificate, or less of it")
    {
        const auto leaf = client_identity().certificates.front().der();
        std::vector<std::byte> sent{leaf.begin(), leaf.end()};
        const bool has_more = GENERATE(true, false);
        has_more ? sent.push_back(std::byte{0x30}) : sent.pop_back();
        request.client_certificate = ByteString{sent};
        CHECK(client.create_session(request).error() == status::Bad_SecurityChecksFailed);
    }
    SECTION("another ApplicationUri")
    {
        request.client_description.application_uri = "urn:busbar:test:client2";
        CHECK(client.create_session(request).error() == status::Bad_CertificateUriInvalid);
    }
    SECTION("another server")
    {
        request.server_uri = "urn:busbar:test:server2";
        CHECK(client.create_session(request).error() == status::Bad_ServerUriInvalid);
    }
    CHECK(fixture.server.session_count() == 0);
}

TEST_CASE("a certificate comes with issuers in CreateSession, or without them")
{
    ServerFixture fixture;
    auto client = fixture.connect(sign);
    auto request = client.create_request();
    std::vector<std::byte> sent;
    for (const auto& each :
         {client_identity().certificates.front(), server_identity().certificates.front()}) {
        sent.insert(sent.end(), each.der().begin(), each.der().end());
    }
    request.client_certificate = ByteString{sent};
    CHECK(client.create_session(request));
}

TEST_CASE("a client without security may leave out its nonce",
          "[unit:Security None CreateSession ActivateSession]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    auto request = client.create_request();
    request.client_nonce = {};
    CHECK(client.create_session(request));
    request.client_nonce = ByteString{std::vector<std::byte>(8)};
    CHECK(client.create_session(request).error() == status::Bad_NonceInvalid);
}

TEST_CASE("services need an activated session of their own channel")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    CHECK(use(client) == status::Bad_SessionIdInvalid);
    auto other = fixture.log_in();

    SECTION("of another channel")
    {
        client.adopt(other);
        CHECK(use(client) == status::Bad_SecureChannelIdInvalid);
        CHECK(client.close_session() == status::Bad_SecureChannelIdInvalid);
        CHECK(use(other) == status::Good);
    }
    SECTION("not activated: it is closed")
    {
        REQUIRE(client.create_session());
        CHECK(use(client) == status::Bad_SessionNotActivated);
        CHECK(client.activate(TestClient::anonymous()) == status::Bad_SessionIdInvalid);
    }
    SECTION("not activated, from another channel: nothing happens to it")
    {
        REQUIRE(client.create_session());
        auto thief = fixture.connect();
        thief.adopt(client);
        CHECK(use(thief) == status::Bad_SecureChannelIdInvalid);
        CHECK(thief.activate(TestClient::anonymous()) == status::Bad_SecureChannelIdInvalid);
        CHECK(client.activate(TestClient::anonymous()) == status::Good);
    }
}

TEST_CASE("ActivateSession wants the client's signature")
{
    ServerFixture fixture;
    auto client = fixture.connect(sign);
    REQUIRE(client.create_session());
    ActivateSessionRequest request;
    request.client_signature = client.signature();
    request.user_identity_token = client.user("operator", "operator-secret");
    SECTION("missing")
    {
        request.client_signature = {};
    }
    SECTION("wrong")
    {
        std::vector<std::byte> bytes{request.client_signature.signature.span().begin(),
                                     request.client_signature.signature.span().end()};
        bytes[0] ^= std::byte{1};
        request.client_signature.signature = ByteString{bytes};
    }
    SECTION("by another algorithm")
    {
        request.client_signature.algorithm = "http://www.w3.org/2000/09/xmldsig#rsa-sha1";
    }
    SECTION("over an old nonce")
    {
        REQUIRE(client.activate(client.user("operator", "operator-secret")) == status::Good);
        request.user_identity_token = client.user("operator", "operator-secret");
    }
    CHECK(client.status_of<ActivateSessionResponse>(request) ==
          status::Bad_ApplicationSignatureInvalid);
}

TEST_CASE("a session moves to another channel of the same client and user")
{
    ServerFixture fixture;
    auto old = fixture.log_in(encrypt);
    SECTION("all right")
    {
        auto client = fixture.connect(encrypt);
        client.adopt(old);
        CHECK(client.activate(client.user("operator", "operator-secret")) == status::Good);
        CHECK(use(client) == status::Good);
        CHECK(use(old) == status::Bad_SecureChannelIdInvalid);
    }
    SECTION("another user")
    {
        auto client = fixture.connect(encrypt);
        client.adopt(old);
        CHECK(client.activate(client.user("engineer", "engineer-secret")) ==
              status::Bad_IdentityChangeNotSupported);
        CHECK(use(old) == status::Good);
    }
    SECTION("weaker security")
    {
        const auto security = GENERATE(channel::SecuritySetting{}, sign);
        auto client = fixture.connect(security);
        client.adopt(old);
        CHECK(client.activate(client.user("operator", "operator-secret")) ==
              status::Bad_SecurityChecksFailed);
    }
    SECTION("another certificate")
    {
        static const auto identity = make_identity("client2");
        auto client = fixture.connect(encrypt, identity);
        client.adopt(old);
        CHECK(client.activate(client.user("operator", "operator-secret")) ==
              status::Bad_SecurityChecksFailed);
    }
}

TEST_CASE("a session outlives its connection until it times out")
{
    ServerFixture fixture;
    auto client = std::make_unique<TestClient>(fixture.log_in());
    const NodeId token = client->authentication_token;
    client.reset();
    CHECK(fixture.server.connection_count() == 0);
    CHECK(fixture.server.session_count() == 1);
    SECTION("taken up again")
    {
        fixture.advance(59s);
        auto next = fixture.connect();
        next.authentication_token = token;
        CHECK(next.activate(TestClient::anonymous()) == status::Good);
        fixture.advance(59s);
        CHECK(use(next) == status::Good);
    }
    SECTION("not taken up")
    {
        CHECK(fixture.server.next_deadline() == fixture.now + 60s);
        fixture.advance(60s);
        CHECK(fixture.server.session_count() == 0);
        CHECK(fixture.server.next_deadline() == no_deadline);
    }
}

TEST_CASE("a session that was never activated goes with its connection")
{
    ServerFixture fixture;
    auto client = std::make_unique<TestClient>(fixture.connect());
    REQUIRE(client->create_session());
    client.reset();
    CHECK(fixture.server.session_count() == 0);
}

TEST_CASE("an anonymous session in mode Sign stays on its channel")
{
    auto config = ServerFixture::secure_config();
    for (auto& endpoint : config.endpoints) {
        endpoint.allows_anonymous = true;
    }
    ServerFixture fixture{std::move(config)};
    const auto security = GENERATE(sign, encrypt);
    auto old = fixture.connect(security);
    REQUIRE(old.create_session());
    REQUIRE(old.activate(TestClient::anonymous()) == status::Good);
    auto client = fixture.connect(security);
    client.adopt(old);
    CHECK(client.activate(TestClient::anonymous()) ==
          (security == sign ? status::Bad_SecurityModeInsufficient : status::Good));
}

TEST_CASE("sessions that nobody activates are few and short")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_sessions = 3;
    config.limits.max_sessions_per_channel = 2;
    ServerFixture fixture{std::move(config)};
    auto user = fixture.log_in();
    auto flood = fixture.connect();
    REQUIRE(flood.create_session());
    const NodeId oldest = flood.authentication_token;
    fixture.advance(1s);
    REQUIRE(flood.create_session());
    CHECK(flood.create_session().error() == status::Bad_TooManySessions); // of one channel

    SECTION("the oldest gives way")
    {
        auto next = fixture.log_in();
        CHECK(fixture.server.session_count() == 3);
        flood.authentication_token = oldest;
        CHECK(flood.activate(TestClient::anonymous()) == status::Bad_SessionIdInvalid);
        CHECK(use(user) == status::Good);
        SECTION("activated ones do not")
        {
            auto last = fixture.log_in();
            auto none = fixture.connect();
            CHECK(none.create_session().error() == status::Bad_TooManySessions);
        }
    }
    SECTION("they end after the activation timeout")
    {
        fixture.advance(30s);
        CHECK(fixture.server.session_count() == 1);
    }
}

TEST_CASE("tokens and nonces never repeat")
{
    ServerFixture fixture;
    std::set<NodeId> tokens;
    std::set<ByteString> nonces;
    for (int i = 0; i < 500; ++i) {
        auto client = fixture.connect();
        REQUIRE(client.create_session());
        CHECK(tokens.insert(client.authentication_token).second);
        CHECK(nonces.insert(client.server_nonce).second);
        REQUIRE(client.close_session() == status::Good);
    }
}

TEST_CASE("sessions need an endpoint with the channel's security")
{
    ServerFixture fixture{ServerFixture::secure_config()};
    auto client = fixture.connect();
    CHECK(client.create_session().error() == status::Bad_SecurityPolicyRejected);
}

} // namespace session_test
