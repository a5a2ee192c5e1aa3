#include <catch2/catch.hpp>

#include "client_fixture.hpp"

namespace few_connections_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

namespace {

/// Anonymous, over None only.
client::ClientConfig insecure_at(const char* url)
{
    auto config = ClientFixture::insecure();
    config.endpoint_url = url;
    return config;
}

} // namespace

TEST_CASE("a session without security needs one connection only",
          "[unit:Session Client Single Session]")
{
    const bool is_reverse = GENERATE(false, true);
    auto config = insecure_at("opc.tcp://LOCALHOST:4840/");
    config.is_reverse = is_reverse;
    ClientFixture plant{config};
    plant.connect();
    if (is_reverse) {
        plant.call();
    }
    INFO(plant.log.text);
    REQUIRE(plant.is_ready());
    CHECK(plant.urls.size() == 1);
    CHECK(plant.site->server.session_count() == 1);
    plant.read();
    plant.run();
    CHECK(plant.answers == std::vector<StatusCode>{status::Good});
    // The second time the endpoint is known, and the session is taken over as ever.
    plant.cut();
    plant.advance(1s);
    if (is_reverse) {
        plant.call();
    }
    CHECK(plant.is_ready());
    CHECK(plant.urls.size() == 2);
    CHECK(plant.site->server.session_count() == 1);
    plant.advance(2h); // the token is renewed
    CHECK(plant.is_ready());
}

TEST_CASE("a user who is refused on the channel of the endpoints is refused for good")
{
    auto config = ClientFixture::named_user();
    config.identity = client::NamedUser{"operator", "guess"};
    config.security.allows_none = true;
    auto site = UserFixture::all_kinds();
    site.endpoints.erase(site.endpoints.begin(), site.endpoints.begin() + 2);
    ClientFixture plant{config, site};
    plant.connect();
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.client.last_error() == status::Bad_UserAccessDenied);
    CHECK(plant.site->server.session_count() == 0);
}

TEST_CASE("the second connection waits until the server has ended the first")
{
    ClientFixture plant;
    plant.is_closing = false;
    SECTION("which it does")
    {
        plant.connect();
        CHECK(plant.urls.size() == 1);
        CHECK(plant.client.state() == ClientState::Discovering);
        plant.advance(300ms);
        CHECK(plant.urls.size() == 1);
        plant.is_closing = true;
        plant.run();
    }
    SECTION("for a while, if it does not")
    {
        plant.connect();
        plant.advance(1s - 1ns);
        CHECK(plant.urls.size() == 1);
        plant.advance(1ns);
    }
    CHECK(plant.urls.size() == 2);
    CHECK(plant.is_ready());
}

TEST_CASE("who does not want to wait for the server's end need not")
{
    auto config = ClientFixture::named_user();
    config.peer_close_timeout = 0s;
    ClientFixture plant{config};
    plant.is_closing = false;
    plant.connect();
    CHECK(plant.is_ready());
}

TEST_CASE("a user who closes while the server's end is awaited does not wait for long")
{
    ClientFixture plant;
    plant.is_closing = false;
    plant.connect();
    plant.client.close(plant.now);
    plant.advance(1s);
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.urls.size() == 1);
}

TEST_CASE("a server that has no second connection yet is asked again")
{
    auto config = ClientFixture::named_user();
    config.reconnect.is_enabled = false; // one attempt
    ClientFixture plant{config};
    plant.refusal = GENERATE(status::Bad_TcpNotEnoughResources, status::Bad_TcpServerTooBusy);
    plant.is_closing = false;
    plant.connect();
    plant.refusals = 2;
    plant.is_closing = true;
    plant.run();
    CHECK(plant.urls.size() == 2);
    CHECK(plant.client.state() == ClientState::Connecting);
    plant.advance(500ms);
    CHECK(plant.urls.size() == 3);
    CHECK_FALSE(plant.is_ready());
    plant.advance(1s - 1ns);
    CHECK(plant.urls.size() == 3);
    plant.advance(1ns);
    CHECK(plant.urls.size() == 4);
    CHECK(plant.is_ready());
    CHECK(plant.log.text.find("not opened a second connection yet") != std::string::npos);
}

TEST_CASE("a server that stays full is given up with its own words")
{
    auto config = ClientFixture::named_user();
    config.reconnect.is_enabled = false;
    ClientFixture plant{config};
    plant.is_closing = false;
    plant.connect();
    plant.refusals = 100;
    plant.is_closing = true;
    plant.run();
    plant.advance(10s);
    CHECK(plant.urls.size() == 5); // endpoints, the second connection, three more
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.client.last_error() == status::Bad_TcpNotEnoughResources);
}

TEST_CASE("a server that is full from the beginning is tried in later attempts")
{
    ClientFixture plant;
    plant.refusals = 1;
    plant.connect();
    CHECK(plant.client.state() == ClientState::Waiting);
    CHECK(plant.urls.size() == 1);
    plant.advance(1s);
    CHECK(plant.is_ready());
    CHECK(plant.urls.size() == 3);
}

} // namespace few_connections_test
