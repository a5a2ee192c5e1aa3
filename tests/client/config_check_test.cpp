#include <catch2/catch.hpp>

#include <busbar/client/config_check.hpp>
#include <busbar/client/registration.hpp>

#include "client_fixture.hpp"

namespace config_check_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// A configuration that is right until a test changes it.
struct ClientMistake {
    ClientMistake() { REQUIRE(client::check_config(config, environment)); }
    void check_refused(StatusCode status, std::string_view where, std::string_view reason)
    {
        const auto checked = client::check_config(config, environment);
        REQUIRE_FALSE(checked);
        CHECK(checked.error().status == status);
        CHECK(checked.error().where == where);
        CHECK(checked.error().text.find(reason) != std::string::npos);
    }

    client::ClientConfig config = ClientFixture::named_user();
    SeededRandom random;
    FixedWallClock clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    channel::ChannelEnvironment environment{.random = &random,
                                            .wall_clock = &clock,
                                            .log = &log,
                                            .validator = &validator,
                                            .identity = &client_identity()};
};

} // namespace

TEST_CASE_METHOD(ClientMistake, "what a client cannot do without is named when it is missing")
{
    const char* where = "";
    SECTION("random numbers")
    {
        environment.random = nullptr;
        where = "environment.random";
    }
    SECTION("the time of day")
    {
        environment.wall_clock = nullptr;
        where = "environment.wall_clock";
    }
    SECTION("a log")
    {
        environment.log = nullptr;
        where = "environment.log";
    }
    SECTION("somebody who knows the server's certificate")
    {
        environment.validator = nullptr;
        where = "environment.validator";
    }
    SECTION("a certificate of its own")
    {
        environment.identity = nullptr;
        where = "environment.identity";
    }
    check_refused(status::Bad_ConfigurationError, where, "is null");
}

TEST_CASE_METHOD(ClientMistake, "a client without security needs no certificates")
{
    environment.validator = nullptr;
    environment.identity = nullptr;
    config.security.allows_none = true;
    CHECK(client::check_config(config, environment));
}

TEST_CASE_METHOD(ClientMistake, "a client's configuration must be of use for some server")
{
    SECTION("URL")
    {
        config.endpoint_url = "localhost:4840";
        check_refused(status::Bad_TcpEndpointUrlInvalid, "endpoint_url", "\"localhost:4840\"");
        config.is_reverse = true; // the server calls
        CHECK(client::check_config(config, environment));
    }
    SECTION("policy")
    {
        config.security.policies = {"Basic256Sha256", "Basic512"};
        check_refused(status::Bad_ConfigurationError, "security.policies", "knows no Basic512");
    }
    SECTION("user")
    {
        auto user = std::get<client::CertificateUser>(ClientFixture::certificate_user());
        user.key.reset();
        config.identity = std::move(user);
        check_refused(status::Bad_ConfigurationError, "identity", "no key");
    }
}

TEST_CASE("a client with a configuration that is none asks for no connection and says why")
{
    auto config = ClientFixture::named_user();
    config.endpoint_url = "localhost:4840";
    ClientFixture plant{config};
    plant.connect();
    CHECK(plant.urls.empty());
    CHECK(plant.client.state() == client::ClientState::Closed);
    CHECK(plant.client.last_error() == status::Bad_TcpEndpointUrlInvalid);
    CHECK(plant.log.text.find("endpoint_url: \"localhost:4840\" is not a URL") !=
          std::string::npos);
}

TEST_CASE("the name that a server has in mDNS has 63 bytes at most (RFC 6763, 4.1.1)")
{
    client::RegistrationSettings settings;
    settings.server.server_uri = "urn:busbar:test:server";
    settings.server.server_names = {LocalizedText{"press"}};
    settings.server.discovery_urls = {"opc.tcp://press:4840"};
    settings.mdns.mdns_server_name = std::string(63, 'x');
    CHECK(client::Registration::check(settings));
    settings.mdns.mdns_server_name = std::string(64, 'x');
    const auto checked = client::Registration::check(settings);
    REQUIRE_FALSE(checked);
    CHECK(checked.error() == status::Bad_InvalidArgument);
}

} // namespace config_check_test
