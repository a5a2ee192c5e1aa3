#include <catch2/catch.hpp>

#include "client_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

namespace {

using Statuses = std::vector<StatusCode>;

client::UserIdentity maria()
{
    return client::CertificateUser{user_certificate().certificate,
                                   std::make_shared<crypto::PrivateKey>(user_certificate().key)};
}

bool has_state(const ClientFixture& plant, ClientState state, StatusCode why)
{
    return std::ranges::count(plant.states, std::pair{state, why}) != 0;
}

/// What CreateSession and ActivateSession look like to the server from now on.
std::size_t sessions(const ClientFixture& plant)
{
    return plant.site->server.session_count();
}

} // namespace

TEST_CASE("a client finds the best endpoint and opens a session for every kind of user")
{
    const client::UserIdentity identity =
        GENERATE(client::UserIdentity{client::NamedUser{"operator", "operator-secret"}}, maria(),
                 client::UserIdentity{client::IssuedUser{jwt()}});
    ClientFixture plant{ClientFixture::configuration(identity)};
    plant.connect();
    INFO(plant.log.text << plant.site->log.text);
    REQUIRE(plant.is_ready());
    CHECK(sessions(plant) == 1);
    CHECK(plant.client.endpoint()->security_mode == MessageSecurityMode::SignAndEncrypt);
    CHECK(plant.client.server().namespaces.at(1) == "urn:busbar:test:server");
    CHECK(plant.client.server().servers.at(0) == "urn:busbar:test:server");
    CHECK(plant.client.server().revision == 1);
    plant.read();
    plant.run();
    CHECK(plant.answers == Statuses{status::Good});
    plant.client.close(plant.now);
    plant.run();
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(sessions(plant) == 0);
    CHECK(plant.urls.size() == 2);
}

TEST_CASE("users of every kind log in over a channel without security, their secrets encrypted")
{
    const client::UserIdentity identity =
        GENERATE(client::UserIdentity{client::AnonymousUser{}},
                 client::UserIdentity{client::NamedUser{"operator", "operator-secret"}}, maria(),
                 client::UserIdentity{client::IssuedUser{jwt()}});
    auto config = ClientFixture::configuration(identity);
    config.security.allows_none = true;
    auto site = UserFixture::all_kinds();
    site.endpoints.erase(site.endpoints.begin(), site.endpoints.begin() + 2);
    ClientFixture plant{config, site};
    plant.connect();
    INFO(plant.log.text << plant.site->log.text);
    CHECK(plant.is_ready());
    CHECK(plant.client.endpoint()->security_mode == MessageSecurityMode::None);
    // Who encrypts a secret for a server has to know whose key that is (CVE-2018-12087).
    const bool is_anonymous = std::holds_alternative<client::AnonymousUser>(identity);
    CHECK(plant.validator.asked == (is_anonymous ? 0 : 1));
}

TEST_CASE("no secret goes to a server that is not trusted")
{
    auto config = ClientFixture::named_user();
    config.security.allows_none = true;
    auto site = UserFixture::all_kinds();
    const bool is_secure = GENERATE(false, true);
    if (!is_secure) {
        site.endpoints.erase(site.endpoints.begin(), site.endpoints.begin() + 2);
    }
    ClientFixture plant{config, site};
    ListValidator nobody;
    plant.validator.used = &nobody;
    plant.connect();
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.client.last_error() == status::Bad_CertificateUntrusted);
    CHECK(has_state(plant, ClientState::Closed, status::Bad_CertificateUntrusted));
    CHECK(plant.site->users.asked == 0);
}

TEST_CASE("what cannot be mended by another attempt ends the client, and says why")
{
    auto config = ClientFixture::named_user();
    auto site = UserFixture::all_kinds();
    StatusCode expected;
    SECTION("a wrong password")
    {
        config.identity = client::NamedUser{"operator", "guess"};
        expected = status::Bad_UserAccessDenied;
    }
    SECTION("nothing good enough")
    {
        std::erase_if(site.endpoints, [](const server::EndpointConfig& endpoint) {
            return endpoint.security.mode == MessageSecurityMode::SignAndEncrypt;
        });
        expected = status::Bad_SecurityModeRejected;
    }
    SECTION("only endpoints without security")
    {
        site.endpoints.erase(site.endpoints.begin(), site.endpoints.begin() + 2);
        expected = status::Bad_SecurityPolicyRejected;
    }
    SECTION("no token for the user")
    {
        config.identity = client::AnonymousUser{};
        expected = status::Bad_IdentityTokenRejected;
    }
    SECTION("a policy that nobody knows")
    {
        config.security.policies = {"Basic512"};
        expected = status::Bad_ConfigurationError;
    }
    SECTION("another server")
    {
        config.server_uri = "urn:other";
        expected = status::Bad_ServerUriInvalid;
    }
    ClientFixture plant{config, site};
    plant.connect();
    plant.read();
    plant.advance(1min);
    INFO(plant.log.text << plant.site->log.text);
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.client.last_error() == expected);
    CHECK(plant.answers == Statuses{status::Bad_ServerNotConnected});
    CHECK(plant.urls.size() <= 2);
}

TEST_CASE("a connection that breaks comes back with the same session")
{
    ClientFixture plant;
    plant.connect();
    REQUIRE(plant.is_ready());
    plant.is_carrying = false;
    plant.read();
    plant.run();
    plant.cut();
    plant.is_carrying = true;
    CHECK(plant.answers == Statuses{status::Bad_ConnectionClosed});
    CHECK(plant.client.state() == ClientState::Waiting);
    plant.read();
    plant.advance(700ms);
    CHECK(plant.client.state() == ClientState::Waiting);
    plant.advance(300ms);
    CHECK(plant.is_ready());
    CHECK(plant.answers.back() == status::Good);
    CHECK(sessions(plant) == 1);
    CHECK(plant.urls.size() == 3); // the endpoint is known
    CHECK(plant.client.server().revision == 1);
}

TEST_CASE("what the server has forgotten is made anew")
{
    ClientFixture plant;
    plant.connect();
    SECTION("the session timed out")
    {
        plant.is_reachable = false;
        plant.cut();
        plant.advance(2min);
        CHECK(sessions(plant) == 0);
        plant.is_reachable = true;
        plant.advance(30s);
    }
    SECTION("it restarted")
    {
        plant.restart(UserFixture::all_kinds());
        plant.advance(1s);
    }
    SECTION("it restarted with another certificate")
    {
        auto site = UserFixture::all_kinds();
        site.identity = make_identity("server");
        plant.restart(site);
        plant.advance(4s);
    }
    SECTION("it restarted with other namespaces")
    {
        plant.restart(UserFixture::all_kinds());
        REQUIRE(plant.site->server.address_space().add_namespace("urn:more"));
        plant.advance(1s);
        CHECK(plant.client.server().namespaces.back() == "urn:more");
        CHECK(plant.client.server().revision == 2);
    }
    INFO(plant.log.text << plant.site->log.text);
    CHECK(plant.is_ready());
    CHECK(sessions(plant) == 1);
    plant.read();
    plant.run();
    CHECK(plant.answers == Statuses{status::Good});
}
