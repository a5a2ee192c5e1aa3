#include <catch2/catch.hpp>

#include "client_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

TEST_CASE("a client finds the best endpoint and opens a session with every identity")
{
    auto [identity, count] = GENERATE(table<client::UserIdentity, int>({
        {client::NamedUser{"operator", "operator-secret"}, 1},
        {client::CertificateUser{user_certificate().certificate,
                                 std::make_shared<crypto::PrivateKey>(user_certificate().key)},
         1},
        {client::IssuedUser{jwt()}, 1},
    }));
    ClientFixture plant{ClientFixture::configuration(identity)};
    plant.connect();
    INFO(plant.log.text << plant.site->log.text);
    REQUIRE(plant.is_ready());
    CHECK(plant.site->server.session_count() == 1);
    CHECK(plant.client.endpoint()->security_mode == MessageSecurityMode::SignAndEncrypt);
    CHECK(plant.client.server().namespaces.at(1) == "urn:busbar:test:server");
    plant.read();
    plant.run();
    CHECK(plant.answers == std::vector<StatusCode>{status::Good});
    plant.client.close(plant.now);
    plant.run();
    CHECK(plant.client.state() == ClientState::Closed);
    CHECK(plant.site->server.session_count() == 0);
    CHECK(plant.urls.size() == 2);
}
