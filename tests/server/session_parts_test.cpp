#include <catch2/catch.hpp>

#include <busbar/server/server_config.hpp>

#include "server/session/session_services.hpp"
#include "support/identity.hpp"
#include "support/seeded_random.hpp"

namespace session_parts_test {

// Sessions without a server: the folder's own headers and what lies below them.

using namespace busbar;
using namespace busbar::server::detail;
using namespace busbar::test;

namespace {

/// A connection whose channel was never opened, which is as good as one without security.
struct SilentPeer final : Peer {
    explicit SilentPeer(const channel::ChannelEnvironment& environment)
        : own_channel{{}, environment, TimePoint{}}
    {
    }

    [[nodiscard]] const channel::ServerChannel& channel() const override { return own_channel; }
    [[nodiscard]] std::uint32_t listener() const override { return 7; }
    [[nodiscard]] std::string_view address() const override { return "192.0.2.1"; }
    [[nodiscard]] const std::vector<Session*>& sessions() const override { return bound; }
    void bind(Session& session) override
    {
        session.peer = this;
        bound.push_back(&session);
    }
    void unbind(Session& session) override
    {
        session.peer = nullptr;
        std::erase(bound, &session);
    }
    void end_operations(const Session&, StatusCode) override {}
    [[nodiscard]] Turn& turn() override { return own_turn; }
    [[nodiscard]] LogSink& log() override { return book; }
    void respond(const Reply&, std::uint32_t, FunctionRef<void(binary::Writer&)>) override {}
    void fault(const Reply&, StatusCode) override {}
    [[nodiscard]] ResponseHeader response_header(const Reply&, StatusCode) const override
    {
        return {};
    }
    [[nodiscard]] std::size_t max_response_size() const override { return 65'536; }
    void count_fault(Session*, std::uint32_t, StatusCode) override {}
    void mark() override {}
    void wants_sweep() override {}

    channel::ServerChannel own_channel;
    std::vector<Session*> bound;
    Turn own_turn;
    LogBook book;
};

/// Notes what it is told, and removes what is closed.
struct NotingKeeper final : SessionKeeper {
    explicit NotingKeeper(SessionTable& t) : table{t} {}

    void close_session(Session& session, StatusCode status, bool deletes_subscriptions) override
    {
        closed.push_back({status, deletes_subscriptions});
        table.remove(session);
    }
    void session_activated(Session&) override {}
    void user_changed(Session&, TimePoint) override {}
    [[nodiscard]] std::uint32_t cancel(const Session&, std::uint32_t request_handle) override
    {
        return request_handle == 5 ? 3 : 0;
    }

    SessionTable& table;
    std::vector<std::pair<StatusCode, bool>> closed;
};

/// Fails once, at the draw that a test says.
class FailingRandom final : public crypto::Random {
public:
    Result<void> fill(std::span<std::byte> bytes) override
    {
        if (--left == 0) {
            return busbar::fail(status::Bad_ResourceUnavailable);
        }
        return numbers.fill(bytes);
    }

    SeededRandom numbers;
    int left{0};
};

struct SessionParts {
    SessionParts()
    {
        config.endpoints = {server::EndpointConfig{}};
        config.limits.max_sessions = 2;
        config.limits.max_sessions_per_channel = 3;
    }

    Result<CreateSessionResponse> create()
    {
        CreateSessionRequest request;
        request.requested_session_timeout = 60'000;
        CreateSessionResponse response;
        ServiceContext context{peer, nullptr, TimePoint{}};
        const StatusCode status = create_session(needs, context, request, response);
        if (status.is_bad()) {
            return fail(status);
        }
        return response;
    }

    FixedWallClock clock;
    FailingRandom random;
    LogBook log;
    server::ServerEnvironment given{.random = &random, .wall_clock = &clock, .log = &log};
    Guards guards{given, log};
    server::ServerEnvironment environment{guards.environment()};
    server::ServerConfig config;
    SessionTable sessions;
    LoginGuard logins{config.limits};
    PasswordChecks password_checks{nullptr};
    Counters counters;
    NotingKeeper keeper{sessions};
    SessionNeeds needs{config, environment,     guards,   log,    sessions,
                       logins, password_checks, counters, keeper, 1};
    SilentPeer peer{{.random = &random, .wall_clock = &clock, .log = &log}};
};

} // namespace

TEST_CASE("a session is created, bound and counted without a server")
{
    SessionParts parts;
    const auto created = parts.create();
    REQUIRE(created);
    CHECK(created->revised_session_timeout == 60'000);
    CHECK(parts.counters.summary.cumulated_session_count == 1);
    Session* const session = parts.sessions.find(created->authentication_token);
    REQUIRE(session != nullptr);
    CHECK(session->peer == &parts.peer);
    CHECK(session->id == created->session_id);

    SECTION("one that was never activated gives way to another")
    {
        REQUIRE(parts.create());
        REQUIRE(parts.create());
        REQUIRE(parts.keeper.closed.size() == 1);
        CHECK(parts.keeper.closed[0] == std::pair{StatusCode{status::Bad_SessionClosed}, false});
        CHECK(parts.sessions.size() == 2);
    }
    SECTION("those that are activated do not")
    {
        session->is_activated = true;
        const auto second = parts.create();
        REQUIRE(second);
        parts.sessions.find(second->authentication_token)->is_activated = true;
        CHECK(parts.create().error() == status::Bad_TooManySessions);
        CHECK(parts.keeper.closed.empty());
    }
    SECTION("its own channel closes it, and no other")
    {
        SilentPeer stranger{
            {.random = &parts.random, .wall_clock = &parts.clock, .log = &parts.log}};
        CloseSessionRequest request;
        request.delete_subscriptions = true;
        CloseSessionResponse response;
        ServiceContext by_stranger{stranger, session, TimePoint{}};
        CHECK(close_session(parts.needs, by_stranger, request, response) ==
              status::Bad_SecureChannelIdInvalid);
        ServiceContext context{parts.peer, session, TimePoint{}};
        CHECK(close_session(parts.needs, context, request, response) == status::Good);
        CHECK(context.session == nullptr);
        REQUIRE(parts.keeper.closed.size() == 1);
        CHECK(parts.keeper.closed[0].second);
        CHECK(parts.peer.bound.empty());
    }
    SECTION("Cancel asks whoever has the requests")
    {
        ServiceContext context{parts.peer, session, TimePoint{}};
        CancelRequest request;
        request.request_handle = 5;
        CancelResponse response;
        CHECK(cancel(parts.needs, context, request, response) == status::Good);
        CHECK(response.cancel_count == 3);
    }
}

TEST_CASE("without random numbers there is no session, whichever of them are missing")
{
    SessionParts parts;
    for (int draw = 1; draw <= 3; ++draw) { // SessionId, AuthenticationToken, ServerNonce
        INFO(draw);
        parts.random.left = draw;
        const auto created = parts.create();
        REQUIRE_FALSE(created);
        CHECK(created.error() == status::Bad_ResourceUnavailable);
        CHECK(parts.sessions.size() == 0);
        CHECK(parts.peer.bound.empty());
    }
    CHECK(parts.create());
}

TEST_CASE("a channel has so many sessions and no more")
{
    SessionParts parts;
    parts.config.limits.max_sessions = 10;
    for (int i = 0; i < 3; ++i) {
        REQUIRE(parts.create());
    }
    CHECK(parts.create().error() == status::Bad_TooManySessions);
}

} // namespace session_parts_test
