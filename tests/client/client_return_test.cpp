#include <catch2/catch.hpp>

#include "client_fixture.hpp"

namespace client_return_test {

// How a client comes back after a connection was lost.

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

namespace {

using Statuses = std::vector<StatusCode>;

} // namespace

TEST_CASE("a connection that breaks comes back with the same session",
          "[unit:Session Client Auto Reconnect]")
{
    const client::UserIdentity identity = GENERATE(
        client::UserIdentity{client::NamedUser{"operator", "operator-secret"}},
        ClientFixture::certificate_user(), client::UserIdentity{client::IssuedUser{jwt()}});
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
    CHECK(plant.site->server.session_count() == 1);
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
    CHECK(plant.site->server.session_count() == 2); // the old one times out
    CHECK(plant.log.text.find("does not resume the session: Bad_SecurityModeInsufficient") !=
          std::string::npos);
    plant.advance(1min);
    CHECK(plant.site->server.session_count() == 1);
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

TEST_CASE("a server behind a port map is used where it was reached")
{
    auto config = ClientFixture::named_user();
    config.endpoint_url = "opc.tcp://localhost:50361";
    ClientFixture plant{config};
    plant.only_way = config.endpoint_url;
    plant.connect();
    INFO(plant.log.text);
    CHECK(plant.is_ready());
    CHECK(plant.urls == std::vector<std::string>{"opc.tcp://localhost:50361",
                                                 "opc.tcp://localhost:4840",
                                                 "opc.tcp://localhost:50361"});
    CHECK(plant.log.text.find("opc.tcp://localhost:4840 does not answer "
                              "(Bad_CommunicationError); going on with "
                              "opc.tcp://localhost:50361, which it was reached by") !=
          std::string::npos);
    // It stays there.
    plant.cut();
    plant.advance(4s);
    CHECK(plant.is_ready());
    CHECK(plant.urls.size() == 4);
    CHECK(plant.urls.back() == config.endpoint_url);
}

TEST_CASE("the URL of an endpoint is used where it answers")
{
    auto config = ClientFixture::named_user();
    config.endpoint_url = "opc.tcp://localhost:50361";
    ClientFixture plant{config};
    plant.connect();
    CHECK(plant.is_ready());
    CHECK(plant.urls ==
          std::vector<std::string>{"opc.tcp://localhost:50361", "opc.tcp://localhost:4840"});
}

TEST_CASE("a server that is away at both of its URLs is tried again at its own")
{
    auto config = ClientFixture::named_user();
    config.endpoint_url = "opc.tcp://localhost:50361";
    ClientFixture plant{config};
    plant.connect();
    REQUIRE(plant.is_ready());
    plant.is_reachable = false;
    plant.cut();
    plant.advance(10s);
    CHECK_FALSE(plant.is_ready());
    plant.is_reachable = true;
    plant.advance(2min);
    CHECK(plant.is_ready());
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
        CHECK(plant.site->server.session_count() == 0);
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
    CHECK(plant.site->server.session_count() == 1);
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

} // namespace client_return_test
