#include <catch2/catch.hpp>

#include <busbar/server/config_check.hpp>

#include "support/server_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE("the default configuration has no open door")
{
    const server::ServerConfig config;
    REQUIRE(config.endpoints.size() == 2);
    for (const auto& endpoint : config.endpoints) {
        CHECK_FALSE(endpoint.security.policy->is_none());
        CHECK_FALSE(endpoint.allows_anonymous);
        CHECK_FALSE(endpoint.allows_plain_passwords);
    }
}

namespace {

/// A configuration that is right until a test changes it.
struct Contradiction {
    Contradiction()
    {
        environment.validator = &validator;
        environment.users = &users;
        environment.random = &random;
        environment.wall_clock = &clock;
        environment.log = &log;
        REQUIRE(server::check_config(config, environment));
    }
    void check_refused()
    {
        const auto checked = server::check_config(config, environment);
        REQUIRE_FALSE(checked);
        CHECK(checked.error().status == status::Bad_ConfigurationError);
        CHECK(checked.error().found.find(reason) != std::string::npos);
        CHECK(server::Server::create(config, environment).error() ==
              status::Bad_ConfigurationError);
        CHECK(log.text.find(reason) != std::string::npos);
    }

    server::ServerConfig config = ServerFixture::insecure_config();
    crypto::InsecureAcceptAnyCertificate validator;
    PlainUsers users;
    SeededRandom random;
    FixedWallClock clock;
    LogBook log;
    server::ServerEnvironment environment;
    crypto::SecurityPolicy policy = *crypto::find_policy_by_name("Basic256Sha256");
    std::string reason;
};

} // namespace

TEST_CASE_METHOD(Contradiction, "what a server needs for its endpoints must be there")
{
    SECTION("URL")
    {
        config.endpoint_url = "localhost:4840";
        reason = "no URL";
    }
    SECTION("no certificate")
    {
        config.identity.reset();
        reason = "SignAndEncrypt: needs a certificate";
    }
    SECTION("no validator")
    {
        environment.validator = nullptr;
        reason = "needs a certificate";
    }
    SECTION("a key that the policy does not allow")
    {
        policy.min_key_bits = 3072;
        config.endpoints[0].security.policy = &policy;
        reason = "needs a key of 3072 to 4096 bits";
    }
    SECTION("another's key")
    {
        config.identity->key = client_identity().key;
        reason = "does not belong";
    }
    SECTION("another ApplicationUri")
    {
        config.application_uri = "urn:other";
        reason = "urn:other";
    }
    check_refused();
}

TEST_CASE_METHOD(Contradiction, "endpoints must not contradict themselves or each other")
{
    SECTION("plain password")
    {
        config.endpoints[2].password_policy = &crypto::policy_none();
        reason = "not allowed";
    }
    SECTION("nobody")
    {
        environment.users = nullptr;
        reason = "nobody can log in";
    }
    SECTION("policy and mode")
    {
        config.endpoints[0].security.mode = MessageSecurityMode::None;
        reason = "do not go together";
    }
    SECTION("unknown policy")
    {
        config.endpoints[0].security.policy = nullptr;
        reason = "not known";
    }
    SECTION("twice")
    {
        config.endpoints.push_back(config.endpoints[0]);
        reason = "twice";
    }
    SECTION("none")
    {
        config.endpoints.clear();
        reason = "endpoint";
    }
    check_refused();
}

TEST_CASE_METHOD(Contradiction, "a deprecated policy is used under protest")
{
    REQUIRE(server::Server::create(config, environment));
    CHECK(log.text.find("INSECURE") == std::string::npos);
    policy.is_deprecated = true;
    SECTION("for the channel")
    {
        config.endpoints[0].security.policy = &policy;
    }
    SECTION("for passwords")
    {
        config.endpoints[0].password_policy = &policy;
    }
    REQUIRE(server::Server::create(config, environment));
    CHECK(log.text.find("INSECURE") != std::string::npos);
}

TEST_CASE("a server says in time that its certificate expires")
{
    auto config = ServerFixture::secure_config();
    config.endpoint_url = "opc.tcp://localhost:4840";
    config.host_names = {"localhost"};
    ServerFixture fixture{std::move(config)};
    const DateTime end = server_identity().certificates.front().valid_to();
    const auto go_to = [&](DateTime time) {
        fixture.log.text.clear();
        fixture.advance(
            std::chrono::nanoseconds{(time.ticks - fixture.wall_clock.time.ticks) * 100});
        return fixture.log.text;
    };
    const auto days_before_end = [&](std::int64_t days) {
        return DateTime{end.ticks - days * 86'400 * DateTime::ticks_per_second};
    };
    fixture.server.start(fixture.now);
    CHECK(fixture.log.text.find("expires") == std::string::npos);
    CHECK(fixture.server.next_deadline() == fixture.now + 24h);
    CHECK(go_to(days_before_end(31)).empty());
    CHECK(go_to(days_before_end(29)).find("expires at") != std::string::npos);
    CHECK(go_to(DateTime{days_before_end(29).ticks + 1}).empty()); // once a day
    CHECK(go_to(days_before_end(28)).find("expires at") != std::string::npos);
    CHECK(go_to(DateTime{end.ticks + 2 * DateTime::ticks_per_second}).find("expired at") !=
          std::string::npos);
}

TEST_CASE("a server says that its certificate does not name its host")
{
    auto config = ServerFixture::secure_config();
    config.host_names = {"moved.example"};
    ServerFixture fixture{std::move(config)};
    fixture.server.start(fixture.now);
    CHECK(fixture.log.text.find("moved.example") != std::string::npos);
}
