#include <catch2/catch.hpp>

#include <busbar/types/subscription.hpp>

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

TEST_CASE("a server that is not trusted gets no channel, whether it trusts this client or not")
{
    ClientFixture plant;
    ListValidator nobody;
    plant.validator.used = &nobody;
    plant.connect();
    CHECK(plant.client.last_error() == status::Bad_CertificateUntrusted);
    CHECK(plant.urls.size() == 1); // for its endpoints
    CHECK(plant.log.text.find("Trust List Check") != std::string::npos);
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
    SECTION("a password that cannot be encrypted")
    {
        config.identity = client::NamedUser{"operator", std::string(65, 'x')};
        expected = status::Bad_IdentityTokenInvalid;
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
    CHECK(sessions(plant) == 0);
}

TEST_CASE("a connection that breaks comes back with the same session")
{
    const client::UserIdentity identity =
        GENERATE(client::UserIdentity{client::NamedUser{"operator", "operator-secret"}}, maria(),
                 client::UserIdentity{client::IssuedUser{jwt()}});
    ClientFixture plant{ClientFixture::configuration(identity)};
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

TEST_CASE("a session that must not change its channel is replaced")
{
    // An anonymous one in mode Sign has nothing but its token to prove it.
    auto config = ClientFixture::configuration(client::AnonymousUser{});
    config.security.min_mode = MessageSecurityMode::Sign;
    auto site = UserFixture::all_kinds();
    std::erase_if(site.endpoints, [](const server::EndpointConfig& endpoint) {
        return endpoint.security.mode == MessageSecurityMode::SignAndEncrypt;
    });
    site.endpoints[0].allows_anonymous = true;
    ClientFixture plant{config, site};
    plant.connect();
    REQUIRE(plant.is_ready());
    plant.cut();
    plant.advance(1s);
    CHECK(plant.is_ready());
    CHECK(plant.urls.size() == 3);
    CHECK(sessions(plant) == 2); // the old one times out
    CHECK(plant.log.text.find("does not resume the session: Bad_SecurityModeInsufficient") !=
          std::string::npos);
    plant.advance(1min);
    CHECK(sessions(plant) == 1);
}

TEST_CASE("another server at the same address is noticed")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    REQUIRE(plant.is_ready());
    CHECK(plant.log.text.find("another server") == std::string::npos);
    const auto identity = make_identity("other");
    auto site = UserFixture::all_kinds();
    site.application_uri = "urn:busbar:test:other";
    site.identity = identity;
    plant.restart(site);
    plant.advance(4s);
    INFO(plant.log.text);
    CHECK(plant.is_ready());
    CHECK(plant.log.text.find("another server answers: urn:busbar:test:other") !=
          std::string::npos);
    CHECK(plant.client.server().revision == 2);
    plant.cut();
    plant.log.text.clear();
    plant.advance(4s);
    CHECK(plant.log.text.find("another server") == std::string::npos);
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
        CHECK(plant.log.text.find("another server") == std::string::npos);
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

TEST_CASE("attempts are counted, and may be none")
{
    auto config = ClientFixture::insecure();
    std::size_t expected = 0;
    SECTION("not again")
    {
        config.reconnect.is_enabled = false;
        expected = 1;
    }
    SECTION("three times")
    {
        config.reconnect.max_attempts = 3;
        expected = 3;
    }
    ClientFixture plant{config};
    plant.is_reachable = false;
    plant.connect();
    plant.advance(1h);
    CHECK(plant.urls.size() == expected);
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.client.last_error() == status::Bad_CommunicationError);
    // Closed is not for ever if the user wants it otherwise.
    plant.is_reachable = true;
    plant.connect();
    CHECK(plant.is_ready());
}

TEST_CASE("closing leaves Subscriptions to others if it is told to")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    plant.client.call<CreateSubscriptionResponse>(
        [] {
            CreateSubscriptionRequest request;
            request.requested_publishing_interval = 1'000;
            request.requested_lifetime_count = 100;
            return request;
        }(),
        [](Result<CreateSubscriptionResponse>) {});
    plant.run();
    REQUIRE(plant.site->server.subscription_count() == 1);
    const bool deletes = GENERATE(false, true);
    plant.client.close(plant.now, deletes);
    plant.run();
    CHECK(plant.site->server.session_count() == 0);
    CHECK(plant.site->server.subscription_count() == (deletes ? 0 : 1));
}

TEST_CASE("without a session there is a channel")
{
    auto config = ClientFixture::insecure();
    config.wants_session = false;
    const bool is_secure = GENERATE(false, true);
    config.security.allows_none = !is_secure;
    ClientFixture plant{config};
    plant.connect();
    REQUIRE(plant.is_ready());
    CHECK(plant.site->server.session_count() == 0);
    CHECK(plant.urls.size() == (is_secure ? 2 : 1));
    std::size_t endpoints = 0;
    plant.client.call<GetEndpointsResponse>(
        GetEndpointsRequest{}, [&](Result<GetEndpointsResponse> response) {
            endpoints = response ? response->endpoints.size() : 0;
        });
    plant.run();
    CHECK(endpoints == 3);
    plant.advance(2h); // the token is renewed
    CHECK(plant.is_ready());
}

TEST_CASE("a server may call instead of being called")
{
    auto config = ClientFixture::named_user();
    config.is_reverse = true;
    config.server_uri = "urn:busbar:test:server";
    ClientFixture plant{config};
    plant.connect();
    // It comes when it likes; no attempt is over meanwhile.
    plant.advance(1h);
    CHECK(plant.client.state() == ClientState::Connecting);
    CHECK(plant.urls.size() == 1);
    plant.call();
    CHECK(plant.client.state() == ClientState::Connecting); // the endpoints are known now
    CHECK(plant.urls.size() == 2);
    plant.advance(1h);
    CHECK(plant.urls.size() == 2);
    plant.call();
    CHECK(plant.is_ready());
    plant.cut();
    plant.advance(1s);
    plant.call();
    INFO(plant.log.text);
    CHECK(plant.is_ready());
    CHECK(sessions(plant) == 1);
    CHECK(plant.urls.size() == 3);
}

TEST_CASE("a server that says good-bye and is gone is tried again in time")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    REQUIRE(plant.is_ready());
    plant.is_reachable = false;
    plant.site->server.begin_shutdown(plant.now, "maintenance");
    plant.advance(2s);
    CHECK(plant.client.state() == ClientState::Waiting);
    plant.advance(10s);
    CHECK(plant.client.last_error() == status::Bad_CommunicationError);
    CHECK(plant.urls.size() >= 3);
}

TEST_CASE("a driver that is stuck in a dead connection does not hold up the next one")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    plant.is_obeying = false;
    plant.is_carrying = false;
    plant.advance(15s);
    CHECK(plant.client.state() == ClientState::Waiting);
    plant.is_obeying = true;
    plant.is_carrying = true;
    plant.advance(5s);
    CHECK(plant.is_ready());
    // What is told of the old one comes too late to matter.
    plant.client.disconnected(plant.order - 1, status::Bad_ConnectionClosed, plant.now);
    plant.client.connected(plant.order - 1, plant.now);
    plant.run();
    CHECK(plant.is_ready());
}

TEST_CASE("nothing is told to a client that has no connection")
{
    ClientFixture plant{ClientFixture::insecure()};
    const std::vector<std::byte> bytes(8);
    CHECK(plant.client.feed(bytes, plant.now).error() == status::Bad_ConnectionClosed);
    plant.client.consume(0);
    plant.client.connected(0, plant.now);
    plant.client.connected(9, plant.now);
    plant.client.disconnected(0, status::Bad_ConnectionClosed, plant.now);
    plant.client.close(plant.now);
    plant.run();
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.urls.empty());
}
