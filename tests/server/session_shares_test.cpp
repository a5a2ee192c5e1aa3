#include <catch2/catch.hpp>

#include <memory>

#include "session_use.hpp"

namespace session_shares_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::string_view greedy_address = "192.0.2.66";

server::ServerConfig few(std::size_t sessions, std::size_t per_user)
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_sessions = sessions;
    config.limits.max_sessions_per_user = per_user;
    return config;
}

struct SessionShares : ServerFixture {
    using ServerFixture::ServerFixture;

    TestClient connect_from(std::string_view address)
    {
        return connect({}, client_identity(), address);
    }
    /// Activated sessions whose connections are gone, the oldest first.
    std::vector<TestClient> leave_behind(std::size_t count, std::string_view address)
    {
        std::vector<TestClient> back;
        for (std::size_t i = 0; i < count; ++i) {
            auto gone = std::make_unique<TestClient>(connect_from(address));
            REQUIRE(gone->open_session() == status::Good);
            back.push_back(connect_from(address));
            back.back().adopt(*gone);
            gone.reset();
            advance(10ms);
        }
        return back;
    }
    [[nodiscard]] bool log_has(const char* part) const
    {
        return log.text.find(part) != std::string::npos;
    }
};

} // namespace

TEST_CASE("sessions without a channel give way, the oldest of the greediest first")
{
    SessionShares fixture{few(6, 6)};
    auto modest = fixture.leave_behind(1, "192.0.2.9");
    auto greedy = fixture.leave_behind(5, greedy_address);
    auto client = fixture.connect();
    REQUIRE(client.open_session() == status::Good);
    CHECK(fixture.server.session_count() == 6);
    CHECK(greedy[0].activate(TestClient::anonymous()) == status::Bad_SessionIdInvalid);
    CHECK(greedy[1].activate(TestClient::anonymous()) == status::Good);
    CHECK(modest[0].activate(TestClient::anonymous()) == status::Good);
    CHECK(use(client) == status::Good);
    CHECK(fixture.log_has("of an anonymous user from 192.0.2.66, without a channel, gives way to a "
                          "session from 192.0.2.1: an anonymous user from 192.0.2.66 had 5 of 6"));
    CHECK_FALSE(fixture.log_has("from 192.0.2.9, without"));
}

TEST_CASE("whoever has as many sessions takes no place of others")
{
    SessionShares fixture{few(4, 4)};
    auto gone = fixture.leave_behind(2, greedy_address);
    auto first = fixture.log_in();
    auto second = fixture.log_in();
    auto third = fixture.connect();
    CHECK(third.create_session().error() == status::Bad_TooManySessions);
    auto own = fixture.connect_from(greedy_address); // from himself he does
    CHECK(own.open_session() == status::Good);
    CHECK(gone[0].activate(TestClient::anonymous()) == status::Bad_SessionIdInvalid);
    CHECK(gone[1].activate(TestClient::anonymous()) == status::Good);
}

TEST_CASE("of sessions that were never activated the greediest network's go first")
{
    SessionShares fixture{few(4, 4)};
    auto good = fixture.connect();
    REQUIRE(good.create_session());
    fixture.advance(1s);
    auto flood = fixture.connect_from(greedy_address);
    for (int i = 0; i < 5; ++i) {
        REQUIRE(flood.create_session());
        fixture.advance(10ms);
    }
    CHECK(fixture.server.session_count() == 4);
    CHECK(good.activate(TestClient::anonymous()) == status::Good);
}

TEST_CASE("a user has a share of the sessions, over all channels")
{
    SessionShares fixture{few(10, 2)};
    auto first = fixture.log_in();
    auto second = fixture.log_in();
    auto third = fixture.connect();
    REQUIRE(third.create_session());
    CHECK(third.activate(TestClient::anonymous()) == status::Bad_TooManySessions);
    CHECK(fixture.log_has("limit max_sessions_per_user"));
    SECTION("others have theirs, from the same address too")
    {
        auto named = fixture.log_in_as("operator");
        auto again = fixture.log_in_as("operator");
        CHECK(use(named) == status::Good);
        CHECK(use(again) == status::Good);
        auto more = fixture.connect(encrypt);
        REQUIRE(more.create_session());
        // The password was right, which is no failure.
        for (int i = 0; i < 10; ++i) {
            CHECK(more.activate(more.user("operator", "operator-secret")) ==
                  status::Bad_TooManySessions);
        }
        CHECK(again.close_session() == status::Good);
        CHECK(more.activate(more.user("operator", "operator-secret")) == status::Good);
        auto other = fixture.connect_from(greedy_address);
        CHECK(other.open_session() == status::Good);
    }
    SECTION("a session is activated again, and by another user")
    {
        CHECK(second.activate(TestClient::anonymous()) == status::Good);
        CHECK(second.activate(second.user("operator", "operator-secret")) == status::Good);
        CHECK(third.activate(TestClient::anonymous()) == status::Good);
        CHECK(second.activate(TestClient::anonymous()) == status::Bad_TooManySessions);
        CHECK(use(second) == status::Good); // the operator's
    }
    SECTION("his own without a channel gives way")
    {
        auto gone = fixture.leave_behind(2, greedy_address);
        auto back = fixture.connect_from(greedy_address);
        CHECK(back.open_session() == status::Good);
        CHECK(gone[0].activate(TestClient::anonymous()) == status::Bad_SessionIdInvalid);
        CHECK(gone[1].activate(TestClient::anonymous()) == status::Good);
    }
}

} // namespace session_shares_test
