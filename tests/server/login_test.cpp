#include <catch2/catch.hpp>

#include <busbar/crypto/encrypted_secret.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "session_use.hpp"
#include "support/server_fixture.hpp"

namespace login_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE("user name tokens",
          "[unit:Security User Name Password][unit:Security User Name Password 2]")
{
    ServerFixture fixture;
    const auto security = GENERATE(channel::SecuritySetting{}, sign, encrypt);
    auto client = fixture.connect(security);
    REQUIRE(client.create_session());
    UserNameIdentityToken token =
        *client.user("operator", "operator-secret").get_if<UserNameIdentityToken>();
    const auto attempt = [&] { return client.activate(ExtensionObject::from(token)); };

    SECTION("right")
    {
        CHECK(attempt() == status::Good);
        CHECK(fixture.log.text.find("secret") == std::string::npos);
    }
    SECTION("wrong password, wrong name and what does not decrypt are one")
    {
        SECTION("password")
        {
            CHECK(client.activate(client.user("operator", "x")) == status::Bad_UserAccessDenied);
        }
        SECTION("name")
        {
            token.user_name = "nobody";
            CHECK(attempt() == status::Bad_UserAccessDenied);
        }
        SECTION("empty password")
        {
            CHECK(client.activate(client.user("operator", "")) == status::Bad_UserAccessDenied);
        }
        SECTION("garbage")
        {
            token.password = ByteString{std::vector<std::byte>(256, std::byte{1})};
            CHECK(attempt() == status::Bad_UserAccessDenied);
        }
        SECTION("encrypted for an older nonce")
        {
            REQUIRE(attempt() == status::Good);
            fixture.users.asked = 0;
            CHECK(attempt() == status::Bad_UserAccessDenied);
        }
        CHECK(fixture.users.asked == 1); // all cost the same
    }
    SECTION("not of the form of the policy")
    {
        SECTION("other policy")
        {
            token.policy_id = "username";
        }
        SECTION("not encrypted")
        {
            token.encryption_algorithm = {};
            token.password = ByteString{std::as_bytes(std::span{"operator-secret", 15})};
        }
        SECTION("no name")
        {
            token.user_name = {};
        }
        CHECK(attempt() == status::Bad_IdentityTokenInvalid);
        CHECK(fixture.users.asked == 0);
    }
    SECTION("another kind of token")
    {
        X509IdentityToken x509;
        x509.policy_id = "x509";
        CHECK(client.activate(ExtensionObject::from(x509)) == status::Bad_IdentityTokenRejected);
    }
}

TEST_CASE("a password of more than 64 bytes comes as an RsaEncryptedSecret",
          "[unit:Security User Name Password]")
{
    ServerFixture fixture;
    const auto security = GENERATE(channel::SecuritySetting{}, sign, encrypt);
    auto client = fixture.connect(security);
    REQUIRE(client.create_session());
    const std::string name(60, 'n');
    auto token = *client.user("operator", "operator-secret").get_if<UserNameIdentityToken>();
    const auto& policy = *crypto::find_policy(security.policy->is_none() ? encrypt.policy->uri
                                                                         : security.policy->uri);
    const auto attempt = [&](std::string_view password) {
        token.user_name = name;
        token.password =
            ByteString{crypto::seal_secret(policy, server_identity().certificates.front(),
                                           std::as_bytes(std::span{password}),
                                           client.server_nonce.span(), fixture.wall_clock.time)
                           .value()};
        return client.activate(ExtensionObject::from(token));
    };
    const std::string right = name + "-secret";
    SECTION("right, whatever encryptionAlgorithm says (Part 4, 7.40.4)")
    {
        token.encryption_algorithm = GENERATE("", "something");
        CHECK(attempt(right) == status::Good);
        CHECK(fixture.log.text.find("secret") == std::string::npos);
    }
    SECTION("wrong, empty or too long")
    {
        CHECK(attempt(GENERATE(std::string{"x"}, std::string{}, std::string(257, 'x'))) ==
              status::Bad_UserAccessDenied);
        CHECK(fixture.users.asked == 1); // all cost the same
    }
    SECTION("for an older nonce")
    {
        REQUIRE(attempt(right) == status::Good);
        CHECK(client.activate(ExtensionObject::from(token)) == status::Bad_UserAccessDenied);
    }
}

TEST_CASE("an anonymous user is let in only where the endpoint says so",
          "[unit:Security User Anonymous][unit:Security User Anonymous Server]")
{
    ServerFixture fixture;
    const auto security = GENERATE(channel::SecuritySetting{}, encrypt);
    auto client = fixture.connect(security);
    REQUIRE(client.create_session());
    const StatusCode expected =
        client.is_secure() ? status::Bad_IdentityTokenRejected : status::Good;
    CHECK(client.activate(TestClient::anonymous()) == expected);
    CHECK(client.activate({}) == expected); // a null token is anonymous
    AnonymousIdentityToken wrong;
    wrong.policy_id = "other";
    CHECK(client.activate(ExtensionObject::from(wrong)) ==
          (client.is_secure() ? status::Bad_IdentityTokenRejected
                              : status::Bad_IdentityTokenInvalid));
}

TEST_CASE("passwords go as they are only if the configuration says so",
          "[unit:Security User Token Unencrypted]")
{
    auto config = ServerFixture::secure_config();
    config.endpoints.push_back({{}, false, true, &crypto::policy_none(), true});
    ServerFixture fixture{std::move(config)};
    auto client = fixture.connect();
    REQUIRE(client.create_session());
    UserNameIdentityToken token;
    token.policy_id = "username_None";
    token.user_name = "operator";
    token.password = ByteString{std::as_bytes(std::span{"operator-secret", 15})};
    CHECK(client.activate(ExtensionObject::from(token)) == status::Good);
    token.encryption_algorithm = encrypt.policy->encryption_uri;
    CHECK(client.activate(ExtensionObject::from(token)) == status::Bad_IdentityTokenInvalid);
}

TEST_CASE("guessing passwords gets slow, then impossible for a while",
          "[unit:Security Invalid user token]")
{
    ServerFixture fixture;
    auto client = fixture.connect(encrypt);
    REQUIRE(client.create_session());
    // A single mistake is answered at once.
    CHECK(client.activate(client.user("operator", "1")) == status::Bad_UserAccessDenied);
    // The next ones are answered later and later.
    for (const auto delay : {250ms, 500ms, 1000ms, 2000ms}) {
        const auto request = client.send_activate(client.user("operator", "2"));
        fixture.advance(delay - 1ms, client);
        REQUIRE(client.take_activate(request) == status::Bad_WouldBlock);
        fixture.advance(1ms, client);
        REQUIRE(client.take_activate(request) == status::Bad_UserAccessDenied);
    }
    CHECK(fixture.users.asked == 5);
    // Now even the right one is not looked at.
    const auto locked = client.send_activate(client.user("operator", "operator-secret"));
    fixture.advance(4s, client);
    CHECK(client.take_activate(locked) == status::Bad_UserAccessDenied);
    CHECK(fixture.users.asked == 5);

    SECTION("for others nothing changes")
    {
        static const auto identity = make_identity("client2");
        auto other = fixture.connect(encrypt, identity, "192.0.2.1");
        auto request = other.create_request();
        request.client_description.application_uri = "urn:busbar:test:client2";
        REQUIRE(other.create_session(request));
        CHECK(other.activate(other.user("operator", "operator-secret")) == status::Good);
    }
    SECTION("it ends")
    {
        fixture.advance(300s);
        auto later = fixture.connect(encrypt);
        REQUIRE(later.create_session());
        CHECK(later.activate(later.user("operator", "operator-secret")) == status::Good);
    }
}

TEST_CASE("a session can change its user", "[unit:Session Change User]")
{
    ServerFixture fixture;
    auto client = fixture.log_in(encrypt);
    CHECK(client.activate(client.user("engineer", "engineer-secret")) == status::Good);
    CHECK(client.activate(client.user("engineer", "wrong")) == status::Bad_UserAccessDenied);
    CHECK(use(client) == status::Good); // it is still the engineer's
}

} // namespace login_test
