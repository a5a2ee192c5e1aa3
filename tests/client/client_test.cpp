#include <catch2/catch.hpp>

#include <busbar/client/connection.hpp>
#include <busbar/types/subscription.hpp>

#include "client_fixture.hpp"

namespace client_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

namespace {

using Statuses = std::vector<StatusCode>;

bool has_state(const ClientFixture& plant, ClientState state, StatusCode why)
{
    return std::ranges::count(plant.states, std::pair{state, why}) != 0;
}

} // namespace

TEST_CASE("a client finds the best endpoint and opens a session for every kind of user",
          "[unit:Base Info Client Basic][unit:Discovery Client Get Endpoints Basic]"
          "[unit:Discovery Client Get Endpoints Dynamic][unit:Session Client Base]"
          "[unit:Security User Name Password Client]"
          "[unit:Security User Name Password 2 Client]"
          "[unit:Security User X509 Client]"
          "[unit:Security User JWT IssuedToken 2 Client]")
{
    const client::UserIdentity identity = GENERATE(
        client::UserIdentity{client::NamedUser{"operator", "operator-secret"}},
        ClientFixture::certificate_user(), client::UserIdentity{client::IssuedUser{jwt()}});
    ClientFixture plant{ClientFixture::configuration(identity)};
    plant.connect();
    INFO(plant.log.text << plant.site->log.text);
    REQUIRE(plant.is_ready());
    CHECK(plant.site->server.session_count() == 1);
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
    CHECK(plant.site->server.session_count() == 0);
    CHECK(plant.urls.size() == 2);
}

TEST_CASE("users of every kind log in over a channel without security, their secrets encrypted",
          "[unit:Security User Anonymous Client]")
{
    const client::UserIdentity identity = GENERATE(
        client::UserIdentity{client::AnonymousUser{}},
        client::UserIdentity{client::NamedUser{"operator", "operator-secret"}},
        ClientFixture::certificate_user(), client::UserIdentity{client::IssuedUser{jwt()}});
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

TEST_CASE("a password that the legacy format has no room for goes as an RsaEncryptedSecret")
{
    const std::string name(GENERATE(57U, 58U, 240U),
                           'n'); // the first is 64 bytes, for the legacy one
    auto config = ClientFixture::configuration(client::NamedUser{name, name + "-secret"});
    ClientFixture plant{config};
    plant.connect();
    INFO(plant.log.text << plant.site->log.text);
    CHECK(plant.is_ready());
    CHECK(plant.site->users.asked == 1);
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
        config.identity = client::NamedUser{"operator", std::string(257, 'x')};
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
    CHECK(plant.site->server.session_count() == 0);
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

TEST_CASE("a server may call instead of being called", "[unit:Protocol Reverse Connect Client]")
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
    CHECK(plant.site->server.session_count() == 1);
    CHECK(plant.urls.size() == 3);
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

TEST_CASE("what was asked for may be answered by elements of a few bytes each", "[client]")
{
    ReadResponse response;
    response.results.resize(65'536);
    for (DataValue& result : response.results) {
        result.value = true;
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, NodeId{0, ReadResponse::binary_encoding_id});
    encode(writer, response);
    client::ConnectionEvent event;
    event.kind = client::ConnectionEvent::Kind::Response;
    event.body = sink.take(writer.written());
    const auto decoded = event.response<ReadResponse>();
    REQUIRE(decoded);
    CHECK(decoded->results.size() == 65'536);
}

} // namespace client_test
