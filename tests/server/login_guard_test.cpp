#include <catch2/catch.hpp>

#include "server/users/login_guard.hpp"
#include "support/effort.hpp"

namespace login_guard_test {

using namespace busbar;
using namespace std::chrono_literals;
using server::detail::LoginAttempt;
using server::detail::LoginGuard;
using server::detail::network_of;

namespace {

/// A guard and its time.
struct Guarded {
    /// The answers' delays of `count` failures one after the other; stops when locked.
    std::vector<Duration> fail(const LoginAttempt& attempt, int count)
    {
        std::vector<Duration> delays;
        while (count-- > 0 && !guard.admit(attempt, now).is_locked) {
            delays.push_back(guard.failed(attempt, now));
        }
        return delays;
    }
    [[nodiscard]] bool is_locked(const LoginAttempt& attempt) const
    {
        return guard.admit(attempt, now).is_locked;
    }
    [[nodiscard]] Duration slow_down(const LoginAttempt& attempt) const
    {
        return guard.admit(attempt, now).delay;
    }

    server::ServerLimits limits;
    LoginGuard guard{limits};
    TimePoint now{1h};
};

std::string numbered(const std::string& name, int number)
{
    return name + std::to_string(number);
}

const LoginAttempt admin{"admin", "AA", "192.0.2.1"};
const LoginAttempt stranger{"admin", "", "198.51.100.7"};

} // namespace

TEST_CASE_METHOD(Guarded, "guessing gets slower, then the user is locked out there")
{
    CHECK(fail(admin, 100) == std::vector<Duration>{0ms, 250ms, 500ms, 1s, 2s});
    CHECK(is_locked(admin));
    CHECK(slow_down(admin) == limits.max_login_delay);
    CHECK_FALSE(is_locked({"maria", "AA", "192.0.2.1"}));
    CHECK_FALSE(is_locked({"admin", "BB", "192.0.2.1"}));
    now += 299s;
    CHECK(is_locked(admin));
    now += 1s;
    CHECK_FALSE(is_locked(admin));
    CHECK(fail(admin, 1) == std::vector<Duration>{0ms}); // forgotten
}

TEST_CASE_METHOD(Guarded, "who tries many names is locked out for all of them")
{
    int tried = 0;
    while (!is_locked({numbered("user", tried), "", "198.51.100.7"})) {
        static_cast<void>(guard.failed({numbered("user", tried), "", "198.51.100.7"}, now));
        ++tried;
    }
    CHECK(tried == 20);
    CHECK(is_locked({"", "", "198.51.100.7"})); // other tokens too
    CHECK_FALSE(is_locked({"user1", "", "198.51.100.8"}));
    CHECK_FALSE(is_locked({"user1", "AA", "198.51.100.7"})); // has a certificate
}

TEST_CASE_METHOD(Guarded, "new certificates do not help, nor do other hosts of one network")
{
    SECTION("certificates")
    {
        int tried = 0;
        while (!is_locked({"admin", numbered("C", tried), "192.0.2.1"})) {
            static_cast<void>(guard.failed({"admin", numbered("C", tried++), "192.0.2.1"}, now));
        }
        CHECK(tried == 20);
    }
    SECTION("IPv6 addresses")
    {
        int tried = 0;
        while (!is_locked({"admin", "", numbered("2001:db8:0:1::", tried)})) {
            static_cast<void>(
                guard.failed({"admin", "", numbered("2001:db8:0:1::", tried++)}, now));
        }
        CHECK(tried == 5);
        CHECK_FALSE(is_locked({"admin", "", "2001:db8:0:2::1"}));
    }
}

TEST_CASE_METHOD(Guarded, "an own account does not help to guess at others'")
{
    const LoginAttempt own{"mallory", "", "198.51.100.7"};
    int tried = 0;
    while (!is_locked(stranger) && tried < 100) {
        static_cast<void>(guard.failed(stranger, now));
        guard.succeeded(own);
        ++tried;
    }
    CHECK(tried == 5);
    // Nor to spray.
    for (tried = 0; !is_locked({numbered("user", tried), "", "198.51.100.7"}); ++tried) {
        static_cast<void>(guard.failed({numbered("user", tried), "", "198.51.100.7"}, now));
        guard.succeeded(own);
    }
    CHECK(tried == 15);
}

TEST_CASE_METHOD(Guarded, "a stranger cannot turn it against the administrator")
{
    SECTION("guessing elsewhere")
    {
        fail(stranger, 100);
        CHECK(is_locked(stranger));
        CHECK_FALSE(is_locked(admin));
        CHECK(slow_down(admin) == 0ms);
    }
    SECTION(
        "guessing from a thousand places: a bounded delay for a new place, none for a known one")
    {
        guard.succeeded(admin);
        for (int i = 0; i < 1'000; ++i) {
            fail({"admin", "", numbered("198.51.100.", i)}, 5);
        }
        CHECK_FALSE(is_locked(admin));
        CHECK(slow_down(admin) == 0ms);
        const LoginAttempt elsewhere{"admin", "BB", "203.0.113.5"};
        CHECK_FALSE(is_locked(elsewhere));
        CHECK(slow_down(elsewhere) == limits.max_login_delay);
        now += 300s;
        CHECK(slow_down(elsewhere) == 0ms);
    }
    SECTION("spraying from his own terminal")
    {
        guard.succeeded(admin);
        for (int i = 0; i < 30; ++i) {
            fail({numbered("user", i), "AA", "192.0.2.1"}, 1);
        }
        CHECK(is_locked({"user1", "AA", "192.0.2.1"}));
        CHECK_FALSE(is_locked(admin));
        fail(admin, 100); // but his own mistakes count
        CHECK(is_locked(admin));
    }
}

TEST_CASE_METHOD(Guarded, "what is being checked is neither a failure nor forgotten")
{
    for (int i = 0; i < 5; ++i) {
        CHECK_FALSE(guard.admit(admin, now).has_to_wait);
        static_cast<void>(guard.begun(LoginGuard::names_of(admin), now));
    }
    CHECK(guard.admit(admin, now).has_to_wait);
    CHECK_FALSE(is_locked(admin));
    CHECK_FALSE(guard.admit({"maria", "AA", "192.0.2.1"}, now).has_to_wait);
    CHECK(slow_down({"admin", "BB", "203.0.113.5"}) == 0ms); // nobody has failed

    SECTION("all fail")
    {
        for (int i = 0; i < 5; ++i) {
            CHECK_FALSE(is_locked(admin));
            guard.ended(LoginGuard::names_of(admin), LoginGuard::End::Wrong, now);
        }
        CHECK(is_locked(admin));
        CHECK_FALSE(guard.admit(admin, now).has_to_wait);
    }
    SECTION("one succeeds: four are still being checked")
    {
        guard.ended(LoginGuard::names_of(admin), LoginGuard::End::Right, now);
        CHECK_FALSE(guard.admit(admin, now).has_to_wait);
        static_cast<void>(guard.begun(LoginGuard::names_of(admin), now));
        CHECK(guard.admit(admin, now).has_to_wait);
    }
    SECTION("those that were not looked at are as if they had not been")
    {
        for (int i = 0; i < 5; ++i) {
            guard.ended(LoginGuard::names_of(admin), LoginGuard::End::NotLookedAt, now);
        }
        CHECK(guard.size() == 0);
    }
    SECTION("of a source, whatever the names")
    {
        for (int i = 0; i < 15; ++i) {
            static_cast<void>(
                guard.begun(LoginGuard::names_of({numbered("user", i), "AA", "192.0.2.1"}), now));
        }
        const LoginAttempt last{"user20", "AA", "192.0.2.1"};
        CHECK(guard.admit(last, now).has_to_wait);
        guard.ended(LoginGuard::names_of({"user3", "AA", "192.0.2.1"}), LoginGuard::End::Right,
                    now);
        CHECK_FALSE(guard.admit(last, now).has_to_wait);
    }
    SECTION("an end that comes after its beginning was forgotten is a failure by itself")
    {
        now += 300s;
        static_cast<void>(guard.failed({"maria", "AA", "192.0.2.1"}, now)); // makes room
        guard.ended(LoginGuard::names_of(admin), LoginGuard::End::Wrong, now);
        CHECK(fail(admin, 100).size() == 4);
    }
}

TEST_CASE_METHOD(Guarded, "no flood washes out what counts")
{
    limits.max_login_entries = 50;
    const int flood = test::is_full_effort() ? 10'000 : 1'000;
    guard.succeeded(admin);
    fail(stranger, 100);
    REQUIRE(is_locked(stranger));
    SECTION("of names")
    {
        for (int i = 0; i < flood; ++i) {
            fail({numbered("name", i), "", numbered("198.51.101.", i / 20)}, 1);
        }
    }
    SECTION("of addresses")
    {
        for (int i = 0; i < flood; ++i) {
            fail({"admin", "", numbered("10.0.0.", i)}, 1);
        }
    }
    SECTION("of addresses that fail until they are locked out")
    {
        for (int i = 0; i < flood; ++i) {
            fail({numbered("name", i), "", numbered("10.0.0.", i)}, 5);
        }
        // There is no place for more: they are slowed down, but not locked out.
        const LoginAttempt late{"maria", "", "10.1.0.0"};
        fail(late, 10);
        CHECK_FALSE(is_locked(late));
        CHECK(slow_down(late) == limits.max_login_delay);
        CHECK(fail(late, 1) == std::vector<Duration>{2s});
    }
    SECTION("of successes of one user")
    {
        for (int i = 0; i < flood; ++i) {
            guard.succeeded({"mallory", "", numbered("10.0.0.", i)});
        }
    }
    CHECK(is_locked(stranger));
    CHECK(slow_down(admin) == 0ms);
    CHECK(guard.size() <= 150);
}

TEST_CASE_METHOD(Guarded, "names may be of any length")
{
    const std::string name(1'000'000, 'x');
    const LoginAttempt attempt{name, "", "192.0.2.1"};
    CHECK(fail(attempt, 100).size() == 5);
    guard.succeeded(attempt);
    CHECK_FALSE(is_locked(attempt));
}

TEST_CASE_METHOD(Guarded, "strangers who guess at a code lock out no other certificate")
{
    const LoginAttempt holder{"setup", "AA", "192.0.2.1", true};
    for (int i = 0; i < 30; ++i) {
        fail({"setup", numbered("stranger", i), "192.0.2.1", true}, 5);
    }
    CHECK(is_locked({"setup", "stranger0", "192.0.2.1", true}));
    CHECK_FALSE(is_locked(holder));
    CHECK(slow_down(holder) == limits.max_login_delay);
    CHECK_FALSE(is_locked({"maria", "AA", "192.0.2.1"})); // nor for other names

    for (int i = 0; i < 30; ++i) {
        fail({numbered("user", i), numbered("guest", i), "192.0.2.1"}, 1);
    }
    CHECK(is_locked({"maria", "AA", "192.0.2.1"}));
    CHECK_FALSE(is_locked(holder));
    CHECK(fail(holder, 100).size() == 5); // by its own failures it is
    CHECK(is_locked(holder));
}

TEST_CASE("networks of addresses")
{
    CHECK(network_of("192.0.2.1") == "192.0.2.1");
    CHECK(network_of("::ffff:192.0.2.1") == "192.0.2.1");
    for (const char* host : {"2001:db8:1:2::", "2001:db8:1:2::1", "2001:db8:1:2:3:4:5:6",
                             "2001:DB8:1:2:ffff:ffff:ffff:ffff", "2001:db8:1:2::192.0.2.1"}) {
        CAPTURE(host);
        CHECK(network_of(host) == "2001:db8:1:2::/64");
    }
    CHECK(network_of("::1") == "0:0:0:0::/64");
    CHECK(network_of("1::2:3:4:5:6:7") == "1:0:2:3::/64");
    CHECK(network_of("fe80::1%eth0") == "fe80:0:0:0::/64");
    for (const char* odd :
         {"", ":", ":::", "::::::::::::", "1:2:3:4:5:6:7:8:9", "x:y", "12345::"}) {
        CAPTURE(odd);
        CHECK_FALSE(network_of(odd).size() > 40);
    }
}

} // namespace login_guard_test
