#include <catch2/catch.hpp>

#include <algorithm>
#include <stdexcept>

#include <busbar/server/running_server.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/subscription.hpp>

#include "support/server_fixture.hpp"

namespace running_server_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using server::RunningServer;

namespace {

constexpr std::uint32_t security_diagnostics =
    id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray;
const auto encrypted = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);

StatusCode read(TestClient& client)
{
    ReadRequest request;
    request.nodes_to_read.resize(1);
    request.nodes_to_read[0].node_id = NodeId{0, id::Server_ServerStatus_State};
    request.nodes_to_read[0].attribute_id = 13;
    return client.status_of<ReadResponse>(request);
}

std::uint32_t subscribe(TestClient& client)
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = 1'000;
    request.requested_lifetime_count = 1'000;
    request.requested_max_keep_alive_count = 10;
    const auto response = client.call<CreateSubscriptionResponse>(request);
    return response ? response->subscription_id : 0;
}

/// Gives roles to one user.
struct OneRule final : server::RoleMapper {
    [[nodiscard]] server::UserRights roles_of(const server::RoleQuestion& question) const override
    {
        asked.push_back(question.user.name + " " + std::string{question.application_uri} + " " +
                        std::string{question.endpoint_url} +
                        (question.is_trusted ? " trusted" : ""));
        return {0, question.user.name == user ? roles : std::vector<std::string>{}};
    }
    [[nodiscard]] server::UserRights limited(const server::RoleQuestion& question,
                                             server::UserRights rights) const override
    {
        if (question.listener == listener_of_data) {
            std::erase(rights.roles, "SecurityAdmin");
        } else if (question.listener == listener_of_nobody) {
            throw std::runtime_error{"limited"};
        }
        return rights;
    }
    static constexpr std::uint32_t listener_of_data = 2;
    static constexpr std::uint32_t listener_of_nobody = 3;

    std::string user{"operator"};
    std::vector<std::string> roles{"SecurityAdmin"};
    mutable std::vector<std::string> asked;
};

struct RoleFixture {
    SeededRandom random;
    FixedWallClock wall_clock;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    PlainUsers users;
    OneRule rule;
    TimePoint now{};
    server::Server server{
        server::Server::create(ServerFixture::insecure_config(), {.random = &random,
                                                                  .wall_clock = &wall_clock,
                                                                  .log = &log,
                                                                  .validator = &validator,
                                                                  .users = &users,
                                                                  .roles = &rule})
            .value()};

    [[nodiscard]] TestClient log_in(std::uint32_t listener = 0)
    {
        auto connection = server.connect("192.0.2.1", now).value();
        connection.came_by(listener);
        TestClient client{std::move(connection), encrypted,
                          channel::ChannelEnvironment{.random = &random,
                                                      .wall_clock = &wall_clock,
                                                      .log = &log,
                                                      .validator = &validator,
                                                      .identity = &client_identity()},
                          now};
        REQUIRE(client.open_session() == status::Good);
        return client;
    }
    /// What only SecurityAdmin may read.
    [[nodiscard]] static StatusCode read_security(TestClient& client)
    {
        ReadRequest request;
        request.nodes_to_read.resize(1);
        request.nodes_to_read[0].node_id = NodeId{0, security_diagnostics};
        request.nodes_to_read[0].attribute_id = 13;
        const auto response = client.call<ReadResponse>(request);
        return response ? response->results[0].status : response.error();
    }
};

} // namespace

TEST_CASE_METHOD(RoleFixture, "roles: what a listener is not for is taken away")
{
    auto anywhere = log_in();
    CHECK(read_security(anywhere) == status::Good);
    auto at_data = log_in(OneRule::listener_of_data);
    CHECK(read_security(at_data) == status::Bad_NodeIdUnknown);
    // Rules that are looked at again do not bring it back.
    server::RunningServer{server}.roles_changed();
    CHECK(read_security(at_data) == status::Bad_NodeIdUnknown);
    CHECK(read_security(anywhere) == status::Good);
}

TEST_CASE_METHOD(RoleFixture, "roles: one who is limited by something that throws has no rights")
{
    auto connection = server.connect("192.0.2.1", now).value();
    connection.came_by(OneRule::listener_of_nobody);
    TestClient client{std::move(connection), encrypted,
                      channel::ChannelEnvironment{.random = &random,
                                                  .wall_clock = &wall_clock,
                                                  .log = &log,
                                                  .validator = &validator,
                                                  .identity = &client_identity()},
                      now};
    CHECK(client.open_session().is_bad());
}

TEST_CASE_METHOD(ServerFixture, "reconfigure: what cannot change is refused, and nothing changes")
{
    auto changed = server.config();
    changed.application_uri = "urn:another";
    auto result = RunningServer{server}.reconfigure(changed);
    REQUIRE_FALSE(result);
    CHECK(result.error().where == "application_uri");
    changed = server.config();
    changed.limits.max_assembly += 1;
    CHECK(RunningServer{server}.reconfigure(changed).error().where == "limits.max_assembly");
    changed = server.config();
    changed.endpoints.clear();
    changed.application_name = "Another";
    CHECK_FALSE(RunningServer{server}.reconfigure(changed));
    CHECK(server.config().application_name == "Busbar");
    CHECK(server.config().endpoints.size() == 3);
}

TEST_CASE_METHOD(ServerFixture, "reconfigure: another certificate closes channels, not sessions")
{
    auto client = log_in(encrypted);
    auto plain = log_in();
    const std::uint32_t subscription = subscribe(client);
    REQUIRE(subscription != 0);
    auto changed = server.config();
    changed.identity = make_identity("server");
    REQUIRE(RunningServer{server}.reconfigure(changed));
    CHECK(read(client) == status::Good); // answers that are under way arrive
    CHECK_FALSE(client.is_closed());
    CHECK(server.next_deadline() <= now + 1s);
    advance(1s, client);
    CHECK(client.is_closed());
    CHECK_FALSE(plain.is_closed());
    CHECK(read(plain) == status::Good);
    CHECK(server.session_count() == 2);
    CHECK(server.subscription_count() == 1);

    // A client that knows the new certificate goes on with its session.
    auto again = connect();
    GetEndpointsRequest request;
    request.endpoint_url = "opc.tcp://localhost:4840";
    const auto endpoints = again.call<GetEndpointsResponse>(request);
    REQUIRE(endpoints);
    const auto der = changed.identity->certificates.front().der();
    const bool is_told =
        std::all_of(endpoints->endpoints.begin(), endpoints->endpoints.end(),
                    [&](const EndpointDescription& each) {
                        const auto told = each.server_certificate.span();
                        return std::equal(told.begin(), told.end(), der.begin(), der.end());
                    });
    CHECK(is_told);
}

TEST_CASE_METHOD(ServerFixture, "reconfigure: sessions of an endpoint that goes end with it")
{
    auto client = log_in(encrypted);
    auto plain = log_in();
    REQUIRE(subscribe(plain) != 0);
    auto changed = server.config();
    changed.endpoints.pop_back(); // None
    REQUIRE(RunningServer{server}.reconfigure(changed));
    CHECK(server.session_count() == 2); // what is being answered is answered first
    REQUIRE(server.next_deadline() <= now);
    server.handle_deadline(now);
    CHECK(server.session_count() == 1);
    CHECK(server.subscription_count() == 1); // to be transferred
    CHECK(read(client) == status::Good);
    CHECK(read(plain) == status::Bad_SessionIdInvalid);
    auto another = connect();
    CHECK(another.create_session().error() == status::Bad_SecurityPolicyRejected);
}

TEST_CASE_METHOD(ServerFixture, "reconfigure: limits hold from now on")
{
    auto client = log_in();
    auto changed = server.config();
    changed.limits.max_sessions = 1;
    REQUIRE(RunningServer{server}.reconfigure(changed));
    CHECK(read(client) == status::Good);
    auto another = connect();
    CHECK(another.create_session().error() == status::Bad_TooManySessions);
    changed.limits.max_sessions = 10;
    REQUIRE(RunningServer{server}.reconfigure(changed));
    CHECK(another.create_session());
}

TEST_CASE_METHOD(ServerFixture, "the sessions of a user are ended with their Subscriptions")
{
    auto client = log_in(encrypted);
    auto plain = log_in();
    REQUIRE(subscribe(client) != 0);
    REQUIRE(subscribe(plain) != 0);
    CHECK(RunningServer{server}.end_sessions(
              [](const server::UserIdentity& user) { return user.name == "operator"; }) == 1);
    CHECK(server.session_count() == 1);
    CHECK(server.subscription_count() == 1);
    CHECK(read(client) == status::Bad_SessionIdInvalid);
    CHECK(read(plain) == status::Good);
}

TEST_CASE_METHOD(RoleFixture, "roles are given by rules, at once when these change",
                 "[unit:Security Role Server Authorization]")
{
    auto client = log_in();
    CHECK(rule.asked == std::vector<std::string>{"operator urn:busbar:test:client "
                                                 "opc.tcp://localhost:4840 trusted"});
    CHECK(read_security(client) == status::Good);
    rule.user = "another";
    RunningServer{server}.roles_changed();
    CHECK(read_security(client) == status::Bad_NodeIdUnknown); // not to be seen
    rule.user = "operator";
    RunningServer{server}.roles_changed();
    CHECK(read_security(client) == status::Good);
}

TEST_CASE_METHOD(RoleFixture, "who has to change the password can do nothing else")
{
    users.must_change = true;
    TestClient client{server.connect("192.0.2.1", now).value(), encrypted,
                      channel::ChannelEnvironment{.random = &random,
                                                  .wall_clock = &wall_clock,
                                                  .log = &log,
                                                  .validator = &validator,
                                                  .identity = &client_identity()},
                      now};
    CHECK(client.open_session() == status::Good_PasswordChangeRequired);
    CHECK(rule.asked.empty());
    CHECK(read_security(client) == status::Bad_NodeIdUnknown); // not to be seen
    CallRequest call;
    call.methods_to_call.resize(1);
    call.methods_to_call[0].object_id = NodeId{0, id::Server};
    call.methods_to_call[0].method_id = NodeId{0, id::Server_GetMonitoredItems};
    const auto response = client.call<CallResponse>(call);
    REQUIRE(response);
    CHECK(response->results[0].status_code == status::Bad_UserAccessDenied);
}

} // namespace running_server_test
