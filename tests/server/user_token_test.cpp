#include <catch2/catch.hpp>

#include "user_fixture.hpp"

namespace user_token_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const crypto::SecurityPolicy& policy()
{
    return *crypto::find_policy_by_name("Basic256Sha256");
}

TestClient connected(UserFixture& fixture, const channel::SecuritySetting& security = encrypt)
{
    auto client = fixture.connect(security);
    REQUIRE(client.create_session());
    return client;
}

} // namespace

TEST_CASE("endpoints say which tokens they accept",
          "[unit:Security User JWT Token Policy][unit:OAuth2 Authority Profile]")
{
    UserFixture fixture;
    auto client = fixture.connect();
    const auto policies_of = [&](std::size_t endpoint) {
        const auto response = client.call<GetEndpointsResponse>(GetEndpointsRequest{});
        REQUIRE(response);
        return response->endpoints[endpoint].user_identity_tokens;
    };
    const auto policies = policies_of(0);
    REQUIRE(policies.size() == 3);
    CHECK(policies[0].policy_id.view() == "username_Basic256Sha256");
    CHECK(policies[1].policy_id.view() == "certificate_Basic256Sha256");
    CHECK(policies[1].token_type == UserTokenType::Certificate);
    CHECK(policies[1].security_policy_uri.view() == policy().uri);
    CHECK(policies[2].policy_id.view() == "issued_Basic256Sha256");
    CHECK(policies[2].token_type == UserTokenType::IssuedToken);
    CHECK(policies[2].issued_token_type.view() == "http://opcfoundation.org/UA/UserToken#JWT");
    CHECK(policies[2].issuer_endpoint_url.view() ==
          R"({"ua:resourceId":"urn:busbar:test:server","ua:authorityUrl":"https://issuer",)"
          R"("ua:authorityProfileUri":"http://opcfoundation.org/UA/Authorization#OAuth2"})");
    CHECK(policies_of(2).size() == 4); // without security, anonymous too

    fixture.users.validator = nullptr;
    fixture.users.rules.reset();
    CHECK(policies_of(0).size() == 1);
}

TEST_CASE("a user logs in with a certificate", "[unit:Security User X509]")
{
    UserFixture fixture;
    const auto security = GENERATE(channel::SecuritySetting{}, sign, encrypt);
    auto client = connected(fixture, security);
    CHECK(fixture.activate(client, certificate_token(), user_signature(client)) == status::Good);
    CHECK(use(client) == status::Good);
    CHECK(fixture.log.text.find("activated by the user of certificate \"CN=maria") !=
          std::string::npos);
    CHECK(fixture.refusals() == 0);
}

TEST_CASE("a user certificate has to be trusted as one")
{
    UserFixture fixture;
    auto client = connected(fixture);
    StatusCode expected = status::Bad_IdentityTokenRejected;
    ExtensionObject token = certificate_token();
    SignatureData signature = user_signature(client);
    std::string reason;
    SECTION("not in the list")
    {
        fixture.validator.list.trusted.clear();
        reason = "Bad_CertificateUntrusted";
    }
    SECTION("a trusted application is not a user")
    {
        token = certificate_token(client_identity().certificates.front().der());
        signature = user_signature(client, client_identity().key);
        reason = client_identity().certificates.front().thumbprint_text();
    }
    SECTION("expired")
    {
        fixture.wall_clock.time = in_days(101);
        reason = "Bad_CertificateTimeInvalid";
    }
    SECTION("of nobody")
    {
        fixture.users.rights = fail(status::Bad_IdentityTokenRejected);
        reason = "it belongs to no user";
    }
    SECTION("unreadable")
    {
        token = certificate_token(user_certificate().certificate.der().subspan(1));
        expected = status::Bad_IdentityTokenInvalid;
        reason = "cannot be read";
    }
    SECTION("null")
    {
        token = certificate_token({});
        expected = status::Bad_IdentityTokenInvalid;
        reason = "cannot be read";
    }
    SECTION("another policy")
    {
        token = certificate_token(user_certificate().certificate.der(), "certificate_None");
        expected = status::Bad_IdentityTokenInvalid;
        reason = "certificate_None";
    }
    CHECK(fixture.activate(client, std::move(token), std::move(signature)) == expected);
    CHECK(fixture.refusals() == 1);
    CHECK(fixture.log.text.find(reason) != std::string::npos);
}

TEST_CASE("the key of a user certificate has to sign")
{
    UserFixture fixture;
    auto client = connected(fixture);
    SignatureData signature = user_signature(client);
    SECTION("no signature")
    {
        signature = {};
    }
    SECTION("with the application's key")
    {
        signature = client.signature();
    }
    SECTION("by another algorithm")
    {
        signature.algorithm = "http://www.w3.org/2000/09/xmldsig#rsa-sha1";
    }
    SECTION("for an older nonce")
    {
        REQUIRE(fixture.activate(client, certificate_token(), signature) == status::Good);
    }
    CHECK(fixture.activate(client, certificate_token(), std::move(signature)) ==
          status::Bad_UserSignatureInvalid);
    CHECK(fixture.refusals() == 1);
    CHECK(fixture.log.text.find("user token signature failed") != std::string::npos);
    CHECK(fixture.log.text.find(user_certificate().certificate.thumbprint_text()) !=
          std::string::npos);
}

TEST_CASE("a user logs in with an issued token, which may be larger than a password",
          "[unit:Security User JWT IssuedToken 2]")
{
    UserFixture fixture;
    const auto security = GENERATE(channel::SecuritySetting{}, sign, encrypt);
    auto client = connected(fixture, security);
    const std::string token = jwt(R"(,"groups":")" + std::string(1'500, 'g') + "\"");
    CHECK(fixture.activate(client, issued_token(client, token)) == status::Good);
    CHECK(use(client) == status::Good);
    CHECK(fixture.log.text.find("activated by user \"maria\" of \"https://issuer\"") !=
          std::string::npos);
    CHECK(fixture.log.text.find(token.substr(0, 30)) == std::string::npos);
}

TEST_CASE("an issued token has to be for this server, now, and from its issuer")
{
    UserFixture fixture;
    auto client = connected(fixture);
    IssuedIdentityToken token = *issued_token(client, jwt()).get_if<IssuedIdentityToken>();
    StatusCode expected = status::Bad_IdentityTokenRejected;
    std::string reason;
    SECTION("other key")
    {
        token = *issued_token(client, hmac_token(R"({"alg":"HS256"})", "{}", "x"))
                     .get_if<IssuedIdentityToken>();
        reason = "signed by another key";
    }
    SECTION("expired")
    {
        fixture.wall_clock.time.ticks += 3'660 * DateTime::ticks_per_second;
        reason = "expired at 2026-01-01T01:00:00Z";
    }
    SECTION("of no user here")
    {
        fixture.users.rights = fail(status::Bad_IdentityTokenRejected);
        reason = "\"maria\" is not a user of this server";
    }
    SECTION("no token")
    {
        token = *issued_token(client, "maria").get_if<IssuedIdentityToken>();
        expected = status::Bad_IdentityTokenInvalid;
        reason = "three parts";
    }
    SECTION("not encrypted")
    {
        token.encryption_algorithm = {};
        expected = status::Bad_IdentityTokenInvalid;
        reason = "not encrypted as the endpoint says";
    }
    SECTION("does not decrypt")
    {
        token.token_data = ByteString{std::vector<std::byte>(512, std::byte{1})};
        reason = "not encrypted for this session";
    }
    SECTION("encrypted for an older nonce")
    {
        REQUIRE(fixture.activate(client, issued_token(client, jwt())) == status::Good);
        reason = "not encrypted for this session";
    }
    SECTION("another policy")
    {
        token.policy_id = "issued";
        expected = status::Bad_IdentityTokenInvalid;
        reason = "names the policy \"issued\"";
    }
    CHECK(fixture.activate(client, ExtensionObject::from(token)) == expected);
    CHECK(fixture.refusals() == 1);
    CHECK(fixture.log.text.find(reason) != std::string::npos);
}

TEST_CASE("tokens of kinds that are not accepted", "[unit:Security Invalid user token]")
{
    UserFixture fixture{ServerFixture::secure_config()};
    auto client = connected(fixture);
    CHECK(fixture.activate(client, certificate_token(), user_signature(client)) ==
          status::Bad_IdentityTokenRejected);
    CHECK(fixture.activate(client, issued_token(client, jwt())) ==
          status::Bad_IdentityTokenRejected);
    CHECK(fixture.activate(client, TestClient::anonymous()) == status::Bad_IdentityTokenRejected);
    CHECK(fixture.activate(client, ExtensionObject::from(ReadValueId{})) ==
          status::Bad_IdentityTokenInvalid);
    CHECK(fixture.refusals() == 4);
    CHECK(fixture.activate(client, client.user("operator", "operator-secret")) == status::Good);
}

TEST_CASE("whatever is wrong with an encrypted password, the answer is one and the same")
{
    UserFixture fixture;
    auto client = connected(fixture);
    const std::string right = "operator-secret";
    const std::string nonce{reinterpret_cast<const char*>(client.server_nonce.span().data()), 32};
    const auto with_length = [](std::uint32_t length, const std::string& text) {
        std::string all;
        for (unsigned shift = 0; shift < 32; shift += 8) {
            all += static_cast<char>(length >> shift & 0xFFU);
        }
        return all + text;
    };
    const auto size = static_cast<std::uint32_t>(right.size() + 32);
    const std::string plain =
        GENERATE_COPY(with_length(0, right + nonce), with_length(31, right + nonce),
                      with_length(32, right + nonce), with_length(size - 1, right + nonce),
                      with_length(size + 1, right + nonce), with_length(0xFFFFFFFF, right + nonce),
                      with_length(size, right + std::string(32, 'n')), with_length(32, nonce),
                      with_length(97, std::string(65, 'p') + nonce), std::string{"abc"},
                      with_length(size, nonce + right), with_length(size - 32, right));
    const auto cipher = crypto::asymmetric_encrypt(policy(), server_identity().certificates.front(),
                                                   std::as_bytes(std::span{plain}));
    REQUIRE(cipher);
    UserNameIdentityToken token;
    token.policy_id = "username_Basic256Sha256";
    token.user_name = "operator";
    token.encryption_algorithm = policy().encryption_uri;
    token.password = ByteString{*cipher};
    CHECK(fixture.activate(client, ExtensionObject::from(token)) == status::Bad_UserAccessDenied);
    CHECK(fixture.users.asked == 1);
    CHECK(fixture.refusals() == 1);
    CHECK(fixture.log.text.find(right) == std::string::npos);
}

TEST_CASE("what a client types never gets into the log")
{
    UserFixture fixture;
    auto client = connected(fixture);
    CHECK(fixture.activate(client, client.user("oper\x1b[2Jator", "hunter2")) ==
          status::Bad_UserAccessDenied);
    CHECK(fixture.activate(client, client.user("operator", "operator-secret")) == status::Good);
    CHECK(fixture.log.text.find("hunter2") == std::string::npos);
    CHECK(fixture.log.text.find("-secret") == std::string::npos);
    CHECK(fixture.log.text.find('\x1b') == std::string::npos);
    CHECK(fixture.log.text.find("user \"oper\\x1B[2Jator\": no such user") != std::string::npos);
    CHECK(fixture.log.text.find("from 192.0.2.1") != std::string::npos);
}

TEST_CASE("a session ends with the certificate or the token of its user")
{
    auto config = UserFixture::all_kinds();
    const bool has_anonymous = GENERATE(false, true);
    for (auto& endpoint : config.endpoints) {
        endpoint.allows_anonymous = has_anonymous;
    }
    UserFixture fixture{std::move(config)};
    auto client = connected(fixture);
    Duration lifetime = 600s;
    SECTION("token")
    {
        REQUIRE(fixture.activate(client, issued_token(client, jwt({}, 600))) == status::Good);
        lifetime += 60s; // of clock skew
    }
    SECTION("certificate")
    {
        fixture.wall_clock.time.ticks =
            user_certificate().certificate.valid_to().ticks - 600 * DateTime::ticks_per_second;
        REQUIRE(fixture.activate(client, certificate_token(), user_signature(client)) ==
                status::Good);
    }
    for (Duration passed = 30s; passed < lifetime; passed += 30s) {
        fixture.advance(30s, client);
        REQUIRE(use(client) == status::Good);
    }
    CHECK(fixture.log.text.find("anonymous now") == std::string::npos);
    fixture.advance(30s, client);
    CHECK(use(client).is_good() == has_anonymous);
    CHECK((fixture.log.text.find("anonymous now") != std::string::npos) == has_anonymous);
    CHECK(fixture.server.session_count() == (has_anonymous ? 1 : 0));
}

} // namespace user_token_test
