#include <catch2/catch.hpp>

#include <optional>

#include <busbar/types/session.hpp>

#include "client/user_token.hpp"
#include "server/user_fixture.hpp"

namespace user_token_test {

using namespace busbar;
using namespace busbar::test;
using client::detail::make_user_token;
using client::detail::UserToken;

namespace {

constexpr auto none = MessageSecurityMode::None;

[[nodiscard]] const crypto::SecurityPolicy* policy_named(std::string_view name)
{
    return crypto::find_policy_by_name(name);
}

/// A client that is to make a token for a server whose certificate it has, over a channel without
/// security.
struct TokenFixture {
    TokenFixture()
    {
        config.channel.endpoint_url = "opc.tcp://localhost:4840";
        config.channel.server_certificate = server();
        policy.policy_id = "token";
        policy.security_policy_uri = String{policy_named("Basic256Sha256")->uri};
    }
    [[nodiscard]] static const crypto::Certificate& server()
    {
        return server_identity().certificates.front();
    }
    [[nodiscard]] Result<UserToken> make(client::UserIdentity identity)
    {
        config.identity = std::move(identity);
        return make_user_token(
            config,
            {.random = &random, .wall_clock = &wall_clock, .log = &log, .validator = validator},
            policy, nonce);
    }
    [[nodiscard]] Result<UserToken> make_named(const std::string& password = "secret")
    {
        return make(client::NamedUser{"maria", password});
    }
    [[nodiscard]] static client::CertificateUser person()
    {
        const auto& user = user_certificate();
        return {user.certificate, std::make_shared<crypto::PrivateKey>(user.key)};
    }

    FixedWallClock wall_clock;
    SeededRandom random;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate anybody;
    ListValidator nobody;
    crypto::CertificateValidator* validator{&anybody};
    client::ConnectionConfig config;
    UserTokenPolicy policy;
    ByteString nonce{std::vector<std::byte>(32, std::byte{5})};
};

} // namespace

TEST_CASE_METHOD(TokenFixture, "A secret is encrypted for the server")
{
    const auto& used = *policy_named("Basic256Sha256");
    const auto read = [&](const ByteString& data) {
        const auto secret =
            crypto::decrypt_secret(used, server_identity().key, data.span(), nonce.span(), 8'192);
        REQUIRE(secret);
        return std::string{secret->text()};
    };
    SECTION("a password")
    {
        const auto made = make_named();
        REQUIRE(made);
        const auto* const token = made->token.get_if<UserNameIdentityToken>();
        REQUIRE(token != nullptr);
        CHECK(token->policy_id.view() == "token");
        CHECK(token->user_name.view() == "maria");
        CHECK(token->encryption_algorithm.view() == used.encryption_uri);
        CHECK(read(token->password) == "secret");
    }
    SECTION("a token of somebody else's")
    {
        const std::string secret(3'000, 'x');
        const auto made = make(client::IssuedUser{secret});
        REQUIRE(made);
        const auto* const token = made->token.get_if<IssuedIdentityToken>();
        REQUIRE(token != nullptr);
        CHECK(token->encryption_algorithm.view() == used.encryption_uri);
        CHECK(read(token->token_data) == secret);
    }
}

TEST_CASE_METHOD(TokenFixture, "No secret leaves for a server that nobody has looked at")
{
    StatusCode expected = status::Bad_CertificateInvalid;
    std::string_view why;
    SECTION("as it shows no certificate")
    {
        config.channel.server_certificate.reset();
        why = "the server shows no certificate";
    }
    SECTION("as there is nobody to look at it")
    {
        validator = nullptr;
        expected = status::Bad_ConfigurationError;
        why = "there is no validator";
    }
    SECTION("as it is not trusted")
    {
        validator = &nobody;
        expected = status::Bad_CertificateUntrusted;
        why = "Bad_CertificateUntrusted";
    }
    CHECK(make_named().error() == expected);
    CHECK(log.text.find(why) != std::string::npos);
    CHECK(make(client::IssuedUser{"token"}).error() == expected);
    // Nor does a signature, which another server could pass on.
    CHECK(make(person()).error() == expected);
}

TEST_CASE_METHOD(TokenFixture, "Secrets that are too large to be encrypted stay here")
{
    CHECK(make_named(std::string(256, 'x')));
    CHECK(make_named(std::string(257, 'x')).error() == status::Bad_IdentityTokenInvalid);
    CHECK(log.text.find("it has more than 256 bytes") != std::string::npos);
    CHECK(make(client::IssuedUser{std::string(8'193, 'x')}).error() ==
          status::Bad_IdentityTokenInvalid);
    CHECK(log.text.find("it has more than 8192 bytes") != std::string::npos);
}

TEST_CASE_METHOD(TokenFixture, "A nonce that is too short makes no token")
{
    nonce = ByteString{std::vector<std::byte>(31)};
    const auto refused = make_named();
    REQUIRE_FALSE(refused);
    CHECK(refused.error() == status::Bad_SecurityChecksFailed);
    CHECK(log.text.find("the server's nonce is too short") != std::string::npos);
    CHECK(make_named(std::string(100, 'x')).error().is_bad());
    CHECK(make(client::IssuedUser{"token"}).error() == status::Bad_SecurityChecksFailed);
    CHECK(make(person()).error() == status::Bad_NonceInvalid);
}

TEST_CASE_METHOD(TokenFixture, "A person without a key proves nothing")
{
    auto user = person();
    user.key = nullptr;
    CHECK(make(user).error() == status::Bad_ConfigurationError);
    const auto made = make(person());
    REQUIRE(made);
    CHECK(made->signature.algorithm.view() == policy_named("Basic256Sha256")->signature_uri);
    const auto* const token = made->token.get_if<X509IdentityToken>();
    REQUIRE(token != nullptr);
    CHECK(std::ranges::equal(token->certificate_data.span(), user.certificate.der()));
}

TEST_CASE_METHOD(TokenFixture, "A token policy that protects nothing is not used")
{
    SECTION("as it has none itself")
    {
        policy.security_policy_uri = String{crypto::policy_none().uri};
    }
    SECTION("as it has that of the channel")
    {
        policy.security_policy_uri = {};
    }
    SECTION("as nobody knows it")
    {
        policy.security_policy_uri = "urn:no:such:policy";
    }
    CHECK(make_named().error() == status::Bad_SecurityPolicyRejected);
    CHECK(make(client::IssuedUser{"token"}).error() == status::Bad_SecurityPolicyRejected);
    CHECK(make(person()).error() == status::Bad_SecurityPolicyRejected);
    CHECK(log.text.empty());
}

TEST_CASE_METHOD(TokenFixture, "Only a channel that encrypts takes a secret as it is")
{
    config.channel.security.policy = policy_named("Basic256Sha256");
    policy.security_policy_uri = String{crypto::policy_none().uri};
    config.channel.security.mode = MessageSecurityMode::Sign;
    CHECK(make_named().error() == status::Bad_SecurityPolicyRejected);
    config.channel.security.mode = MessageSecurityMode::SignAndEncrypt;
    const auto made = make_named();
    REQUIRE(made);
    const auto* const token = made->token.get_if<UserNameIdentityToken>();
    REQUIRE(token != nullptr);
    CHECK(token->encryption_algorithm.is_null());
    CHECK(token->password == ByteString{std::as_bytes(std::span{std::string_view{"secret"}})});
    // A signature with no policy there cannot be.
    CHECK(make(person()).error() == status::Bad_SecurityPolicyRejected);
    config.channel.security.mode = none;
    CHECK(make(client::AnonymousUser{}));
}

} // namespace user_token_test
