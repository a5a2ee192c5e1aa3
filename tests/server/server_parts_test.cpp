#include <catch2/catch.hpp>

#include "server/config_check.hpp"
#include "server/login_guard.hpp"
#include "support/server_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using server::detail::find_contradiction;
using server::detail::LoginGuard;

TEST_CASE("the login guard remembers a bounded number of clients")
{
    server::ServerLimits limits;
    limits.max_login_entries = 2;
    LoginGuard guard{limits};
    TimePoint now{1h};
    for (int i = 0; i < 5; ++i) {
        static_cast<void>(guard.failed("a", now));
    }
    CHECK(guard.is_locked("a", now));
    now += 1s;
    CHECK(guard.failed("b", now) == 0ms);
    CHECK(guard.failed("b", now) == 250ms);
    CHECK(guard.failed("c", now) == 0ms); // the oldest is forgotten
    CHECK_FALSE(guard.is_locked("a", now));
    guard.succeeded("b");
    CHECK(guard.failed("b", now) == 0ms);
}

TEST_CASE("a lock does not grow by trying")
{
    const server::ServerLimits limits;
    LoginGuard guard{limits};
    TimePoint now{1h};
    for (int i = 0; i < 5; ++i) {
        static_cast<void>(guard.failed("a", now));
    }
    CHECK(guard.failed("a", now + 299s) == 4s);
    CHECK_FALSE(guard.is_locked("a", now + 300s));
    CHECK(guard.failed("a", now + 300s) == 0ms);
}

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
        REQUIRE(find_contradiction(config, environment).empty());
    }
    void check_refused()
    {
        CHECK(find_contradiction(config, environment).find(reason) != std::string::npos);
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
