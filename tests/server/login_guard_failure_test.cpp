#include <array>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "server/users/login_guard.hpp"
#include "server/users/password_checks.hpp"
#include "support/failing_allocation.hpp"

namespace login_guard_failure_test {

/// Checks of passwords begin and end while there is no memory.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using server::detail::LoginAttempt;
using server::detail::LoginGuard;
using server::detail::PasswordCheck;

namespace {

/// A guard, and checks of one user at one source: one fewer than may be under way.
struct CheckedWorld {
    CheckedWorld()
    {
        for (PasswordCheck& check : checks) {
            begin(check);
        }
    }
    void begin(PasswordCheck& check)
    {
        check.name = attempt.user;
        static_cast<void>(check.begin(guard, attempt, now));
    }
    [[nodiscard]] bool is_full() const { return guard.admit(attempt, now).has_to_wait; }

    server::ServerLimits limits;
    LoginGuard guard{limits};
    TimePoint now{1h};
    std::string user{"a user whose name is longer than a small string"};
    std::string certificate{"0123456789012345678901234567890123456789"};
    LoginAttempt attempt{user, certificate, "192.0.2.1"};
    std::array<PasswordCheck, 4> checks;
};

/// The user's attempt from a place that nothing is known of.
LoginAttempt elsewhere(const CheckedWorld& world)
{
    return {world.user, "another certificate, as long as that", "2001:db8:1:2::3"};
}

/// False if `work` has all the memory that it takes.
template <typename Work>
bool fails_at(std::size_t k, Work work)
{
    fail_allocation(k);
    const bool has_survived = survives_counted(work);
    fail_allocation(0);
    return !has_survived;
}

} // namespace

TEST_CASE("a check that begins without memory counts nowhere, and takes nothing of another's")
{
    const bool is_elsewhere = GENERATE(false, true);
    std::size_t k = 1;
    for (bool has_failed = true; has_failed; ++k) {
        INFO("allocation " << k);
        CheckedWorld world;
        const LoginAttempt attempt = is_elsewhere ? elsewhere(world) : world.attempt;
        PasswordCheck late;
        late.name = world.user;
        const std::size_t size = world.guard.size();
        has_failed =
            fails_at(k, [&] { static_cast<void>(late.begin(world.guard, attempt, world.now)); });
        if (!has_failed) {
            break;
        }
        CHECK(world.guard.size() == size);
        late.end(LoginGuard::End::NotLookedAt);
        CHECK_FALSE(world.is_full());
        PasswordCheck last;
        world.begin(last);
        CHECK(world.is_full());
        last.end(LoginGuard::End::NotLookedAt);
        for (PasswordCheck& check : world.checks) {
            check.end(LoginGuard::End::NotLookedAt);
        }
        CHECK(world.guard.size() == 0);
    }
    CHECK(k > 3);
}

TEST_CASE("a wrong password counts without memory at the end of its check")
{
    CheckedWorld world;
    PasswordCheck last;
    world.begin(last);
    for (PasswordCheck& check : world.checks) {
        CHECK_FALSE(fails_at(1, [&] { check.end(LoginGuard::End::Wrong); }));
    }
    CHECK_FALSE(fails_at(1, [&] { last.end(LoginGuard::End::Wrong); }));
    CHECK(world.guard.admit(world.attempt, world.now).is_locked);
}

TEST_CASE("a wrong password of one single check counts without memory at its end")
{
    const bool has_certificate = GENERATE(false, true);
    const server::ServerLimits limits;
    LoginGuard guard{limits};
    const std::string user = "a user whose name is longer than a small string";
    const std::string_view certificate = "0123456789012345678901234567890123456789";
    PasswordCheck one;
    one.name = user;
    const TimePoint now{1h};
    static_cast<void>(one.begin(
        guard, {user, has_certificate ? certificate : std::string_view{}, "192.0.2.1"}, now));
    CHECK_FALSE(fails_at(1, [&] { one.end(LoginGuard::End::Wrong); }));
    CHECK(guard.size() != 0);
}

TEST_CASE("a right password that is not remembered without memory ends its check")
{
    CheckedWorld world;
    std::size_t k = 1;
    while (fails_at(k, [&] { world.checks[0].end(LoginGuard::End::Right); })) {
        PasswordCheck next;
        world.begin(next);
        PasswordCheck last;
        world.begin(last);
        CHECK(world.is_full()); // neither more than were begun nor fewer
        last.end(LoginGuard::End::NotLookedAt);
        next.end(LoginGuard::End::NotLookedAt);
        world.begin(world.checks[0]);
        ++k;
    }
    CHECK(k > 1);
    CHECK(world.guard.knows(LoginGuard::source_of(world.attempt)));
}

} // namespace login_guard_failure_test
