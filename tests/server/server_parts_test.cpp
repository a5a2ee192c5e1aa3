#include <catch2/catch.hpp>

#include <busbar/server/config_check.hpp>
#include <busbar/server/worst_case_memory.hpp>

#include "support/server_fixture.hpp"

namespace server_parts_test {

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

// A pointer that stands in another's place would compile: the fields have names instead.
template <typename Environment>
concept FilledByPosition = requires(SeededRandom* random, const FixedWallClock* clock, LogBook* log)
{
    Environment{random, clock, log};
};
template <typename Environment>
concept FilledByName = requires(SeededRandom* random, const FixedWallClock* clock, LogBook* log)
{
    Environment{.random = random, .wall_clock = clock, .log = log};
};
static_assert(FilledByName<server::ServerEnvironment>);
static_assert(!FilledByPosition<server::ServerEnvironment>);
static_assert(FilledByName<channel::ChannelEnvironment>);
static_assert(!FilledByPosition<channel::ChannelEnvironment>);

/// Users of every kind, none of whom exists.
struct EveryKind final : server::UserStore {
    [[nodiscard]] Result<server::UserIdentity> log_in(std::string_view, std::string_view) override
    {
        return fail(status::Bad_UserAccessDenied);
    }
    [[nodiscard]] crypto::CertificateValidator* certificate_validator() override
    {
        return &validator;
    }

    crypto::InsecureAcceptAnyCertificate validator;
};

/// A configuration that is right until a test changes it.
struct Contradiction {
    Contradiction() { REQUIRE(server::check_config(config, environment)); }
    void check_refused()
    {
        const auto checked = server::check_config(config, environment);
        REQUIRE_FALSE(checked);
        CHECK(text(check_created()) == text(checked.error()));
    }
    Problem check_created()
    {
        const auto created = server::Server::create(config, environment, std::move(space));
        REQUIRE_FALSE(created);
        CHECK(created.error().status == expected);
        CHECK(created.error().where == where);
        CHECK(text(created.error()).find(reason) != std::string::npos);
        CHECK((environment.log == nullptr ||
               log.text.find(text(created.error())) != std::string::npos));
        return created.error();
    }

    server::ServerConfig config = ServerFixture::insecure_config();
    crypto::InsecureAcceptAnyCertificate validator;
    PlainUsers users;
    EveryKind every_kind;
    SeededRandom random;
    FixedWallClock clock;
    LogBook log;
    server::ServerEnvironment environment{.random = &random,
                                          .wall_clock = &clock,
                                          .log = &log,
                                          .validator = &validator,
                                          .users = &users};
    model::AddressSpace space;
    crypto::SecurityPolicy policy = *crypto::find_policy_by_name("Basic256Sha256");
    StatusCode expected{status::Bad_ConfigurationError};
    std::string where;
    std::string reason;
};

constexpr const char* first_endpoint = "endpoint Basic256Sha256 SignAndEncrypt";
constexpr const char* open_endpoint = "endpoint None None";

} // namespace

TEST_CASE_METHOD(Contradiction, "what a server cannot do without is named when it is missing")
{
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
    reason = "is null";
    check_refused();
}

TEST_CASE_METHOD(Contradiction, "what a server needs for its endpoints must be there")
{
    SECTION("URL")
    {
        config.endpoint_url = "localhost:4840";
        where = "endpoint_url";
        reason = "not a URL";
    }
    SECTION("ApplicationUri")
    {
        config.application_uri.clear();
        where = "application_uri";
        reason = "is empty";
    }
    SECTION("operations below arrays")
    {
        config.limits.operations.max_monitored_items_per_call = 65'536;
        where = "limits.operations.max_monitored_items_per_call";
        reason = "is 65536, expected less than limits.decode.max_array_length, 65536";
    }
    SECTION("no certificate")
    {
        config.identity.reset();
        where = first_endpoint;
        reason = "SignAndEncrypt: needs a certificate";
    }
    SECTION("no validator")
    {
        environment.validator = nullptr;
        where = first_endpoint;
        reason = "needs a certificate";
    }
    SECTION("a key that the policy does not allow")
    {
        policy.min_key_bits = 3072;
        config.endpoints[0].security.policy = &policy;
        where = first_endpoint;
        reason = "needs a key of 3072 to 4096 bits";
    }
    SECTION("a key alone")
    {
        config.identity->certificates.clear();
        where = "identity";
        reason = "a key but no certificate";
    }
    SECTION("another's key")
    {
        config.identity->key = client_identity().key;
        where = "identity";
        reason = "does not belong";
    }
    SECTION("another ApplicationUri")
    {
        config.application_uri = "urn:other";
        where = "identity";
        reason = "urn:other";
    }
    check_refused();
}

TEST_CASE_METHOD(Contradiction, "endpoints must not contradict themselves or each other")
{
    SECTION("plain password")
    {
        config.endpoints[2].password_policy = &crypto::policy_none();
        where = open_endpoint;
        reason = "not allowed";
    }
    SECTION("encrypted passwords without a certificate")
    {
        config.identity.reset();
        config.endpoints.erase(config.endpoints.begin(), config.endpoints.begin() + 2);
        where = open_endpoint;
        reason = "encrypted passwords need a certificate";
    }
    SECTION("user certificates with nothing to sign with")
    {
        environment.users = &every_kind;
        config.endpoints[2].allows_certificate = true;
        config.endpoints[2].certificate_policy = &crypto::policy_none();
        where = open_endpoint;
        reason = "a policy to sign with";
    }
    SECTION("user certificates without the server's")
    {
        environment.users = &every_kind;
        config.identity.reset();
        config.endpoints = {{}};
        config.endpoints[0].allows_user_name = false;
        config.endpoints[0].allows_certificate = true;
        where = open_endpoint;
        reason = "user certificates need the server's certificate";
    }
    SECTION("nobody")
    {
        environment.users = nullptr;
        where = first_endpoint;
        reason = "no user can log in";
    }
    SECTION("a policy without its mode")
    {
        config.endpoints[0].security.mode = MessageSecurityMode::None;
        where = "endpoint Basic256Sha256 None";
        reason = "do not go together";
    }
    SECTION("a mode without its policy")
    {
        config.endpoints[2].security.mode = MessageSecurityMode::Sign;
        where = "endpoint None Sign";
        reason = "do not go together";
    }
    SECTION("unknown policy")
    {
        config.endpoints[1].security.policy = nullptr;
        where = "endpoint 2";
        reason = "not known";
    }
    SECTION("twice")
    {
        config.endpoints.push_back(config.endpoints[0]);
        where = first_endpoint;
        reason = "twice";
    }
    SECTION("none")
    {
        config.endpoints.clear();
        where = "endpoints";
        reason = "endpoint";
    }
    check_refused();
}

TEST_CASE_METHOD(Contradiction, "channels are rationed by limits that make sense")
{
    auto& limits = config.limits;
    SECTION("nobody could open one")
    {
        limits.max_channel_burst = 0;
        where = "limits.max_channel_burst";
        reason = "expected 1 to";
    }
    SECTION("a table without a place")
    {
        limits.max_channel_entries = 0;
        where = "limits.max_channel_entries";
        reason = "expected 1 to";
    }
    SECTION("each would be a failure")
    {
        limits.max_channel_failures = 0;
        where = "limits.max_channel_failures";
        reason = "expected 1 to";
    }
    SECTION("time that runs backwards")
    {
        limits.max_channel_delay = -1ms;
        where = "limits.max_channel_delay";
        reason = "-1 ms";
    }
    SECTION("failures that are rewarded")
    {
        limits.failed_channel_interval = 10ms;
        where = "limits.failed_channel_interval";
        reason = "shorter than channel_interval";
    }
    check_refused();
}

TEST_CASE_METHOD(Contradiction, "limits for a machine's memory do not contradict each other")
{
    const auto least = server::worst_case_memory(server::small_controller_limits()).total();
    for (std::uint64_t memory = least; memory <= std::uint64_t{32} << 30U; memory += memory / 3) {
        CAPTURE(memory);
        const auto limits = server::limits_for(memory);
        REQUIRE(limits);
        config.limits = *limits;
        CHECK(server::check_config(config, environment));
    }
}

TEST_CASE_METHOD(Contradiction, "a server needs room for its namespace")
{
    while (space.add_namespace("urn:" + std::to_string(space.namespace_count()))) {
    }
    REQUIRE(server::check_config(config, environment));
    expected = status::Bad_TooManyOperations;
    where = "application_uri";
    reason = "no room for one more namespace";
    static_cast<void>(check_created());
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

} // namespace server_parts_test
