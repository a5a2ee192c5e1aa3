#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server::detail {

/// An attempt to log in, and its origin.
struct LoginAttempt {
    /// The name in the token; empty for tokens without a password.
    std::string_view user;
    /// Thumbprint of the client's certificate; empty without security.
    std::string_view certificate;
    std::string_view address;
    /// See UserStore::has_code.
    bool has_code{false};
};

/// Makes guessing slow, then impossible for a while (Part 4, 5.7.3.1), in a way that cannot be
/// turned against others.
///
/// - A *source* is a client's certificate, without one the network it comes from: an IPv4 address
///   or the /64 of an IPv6 address. The clients with certificates of one network are a second
///   source for each of them, so that new certificates do not help. Failures are counted for each
///   source and, within it, for each user name.
///
/// - **Delay**: from a source's second failure on, answers are delayed, each twice as long as the
///   one before.
///
/// - **Lock-out** is of one user at one source, after max_login_failures; and of a source for all
///   users, after max_login_failures_per_source. No user is ever locked out by failures elsewhere.
///
/// - **Known good**: a user who has logged in from a source before is not subject to the source's
///   lock, only to his own lock there. A success forgives only this user's failures at that source,
///   so that an account of one's own does not help to guess at others'.
///
/// - **Slow-down**: a name that fails at many sources is guessed at by many. Logins with it are
///   checked after a bounded delay, except for the known good ones.
///
/// - **At the same time**: no more checks are under way than may fail before a lock-out. The next
///   one waits for the end of one of these, so that many guesses at once achieve no more than one
///   after the other, and many right logins at once all succeed.
///
/// - **Codes**: the name of a random code, which cannot be guessed, is not counted for the network
///   and not subject to its lock, so that strangers cannot keep out the owner of the code. They are
///   slowed down as above.
///
/// Memory is bounded, and no flood displaces counts that matter: one source has one record with a
/// bounded number of names, and beyond those its failures still count for the source. A full table
/// drops the entry with the fewest failures, and never one with more than a single failure; if
/// there is none, the new source gets no record, and a login without a record is slowed down as if
/// it were guessed at. Successes are remembered in a separate table, which takes a password to
/// fill.
///
/// It cannot tell clients without a certificate at one address apart.
class LoginGuard {
public:
    explicit LoginGuard(const ServerLimits& limits) : limits_{&limits} {}

    struct Admission {
        /// Refuse without checking the password.
        bool is_locked{false};
        /// Ask again when a check has ended: if all pending ones are wrong, it is locked.
        bool has_to_wait{false};
        /// The delay before checking it, or before refusing.
        Duration delay{Duration::zero()};
    };
    [[nodiscard]] Admission admit(const LoginAttempt& attempt, TimePoint now) const;
    /// Counts a failure of an admitted attempt; returns the delay of its answer.
    [[nodiscard]] Duration failed(const LoginAttempt& attempt, TimePoint now);
    /// The attempt was right.
    void succeeded(const LoginAttempt& attempt);

    /// The names that an attempt counts for.
    struct Names {
        /// The sources; the first is the more exact one.
        std::string first;
        std::string second; // empty without a certificate and for a code
        std::string user;
    };
    [[nodiscard]] static Names names_of(const LoginAttempt& attempt);

    /// The end of a check that takes time.
    enum class End : std::uint8_t { Right, Wrong, NotLookedAt };
    /// The check of an admitted attempt is under way, until ended() is called with the same names.
    /// Returns the delay of its answer if it is wrong. Counts nothing if it throws.
    [[nodiscard]] Duration begun(const Names& names, TimePoint now);
    /// Ends the check, also if it throws. A failure takes memory only where the entry of the check
    /// has been displaced or forgiven meanwhile.
    void ended(const Names& names, End end, TimePoint now);

    /// Returns the key for rationing the cost of logins: the client's certificate, without one its
    /// network.
    [[nodiscard]] static std::string source_of(const LoginAttempt& attempt);
    /// Returns whether a login from this source has succeeded.
    [[nodiscard]] bool knows(std::string_view source) const;

    /// Entries of all tables, for tests.
    [[nodiscard]] std::size_t size() const
    {
        return sources_.size() + users_.size() + known_good_.size();
    }

private:
    struct Count {
        /// The maximum that it may reach.
        [[nodiscard]] std::size_t most() const { return failures + checks; }

        std::string name;
        /// Failures that are not forgiven yet.
        std::size_t failures{0};
        /// Checks that are under way.
        std::size_t checks{0};
        TimePoint last;
    };
    struct Source : Count {
        std::vector<Count> users;
    };
    struct Success {
        std::string user;
        std::string source;
    };
    /// Entries for a source and a user there, without names where there are entries already.
    struct Made {
        Source source;
        Count user;
    };

    /// Returns true if there is room for a new entry.
    template <typename Entry>
    [[nodiscard]] bool has_place(const std::vector<Entry>& table, std::size_t most,
                                 TimePoint now) const;
    template <typename Entry>
    [[nodiscard]] const Entry* find(const std::vector<Entry>& table, std::string_view name,
                                    TimePoint now) const;
    /// Returns the entry, `made` if it is missing; null if there is no room for it. Takes no memory
    /// after make_entry.
    template <typename Entry>
    [[nodiscard]] Entry* count_in(std::vector<Entry>& table, Entry made, std::string_view name,
                                  std::size_t most, TimePoint now) const;
    /// Makes an entry if it is missing, and room for it.
    template <typename Entry>
    [[nodiscard]] Entry make_entry(std::vector<Entry>& table, std::string_view name,
                                   TimePoint now) const;
    [[nodiscard]] Made make_entries(std::string_view source, std::string_view user, TimePoint now);
    [[nodiscard]] bool is_forgiven(const Count& count, TimePoint now) const;
    [[nodiscard]] bool is_known_good(std::string_view user, std::string_view source) const;
    /// Decides by the failures alone, or else by the pending checks.
    [[nodiscard]] static Admission admission(const Count* count, std::size_t most, Duration delay);
    /// Returns what limits this user at the source, or every user there.
    [[nodiscard]] Admission admit_user(std::string_view source, std::string_view user,
                                       TimePoint now) const;
    [[nodiscard]] Admission admit_source(std::string_view source, TimePoint now) const;
    [[nodiscard]] Duration slow_down(const LoginAttempt& attempt, const Names& names,
                                     TimePoint now) const;
    [[nodiscard]] Duration delay_after(std::size_t failures) const;
    /// Counts one more of a kind everywhere the attempt counts and has a place; returns the number
    /// of failures of the first source if all its checks are wrong. Counts nothing if it throws.
    std::size_t count(const Names& names, std::size_t Count::*kind, TimePoint now);
    std::size_t count_at(std::string_view source, std::string_view user, Made made,
                         std::size_t Count::*kind, TimePoint now);
    /// A check has ended. An entry that did not count it, as its table was full then, gives up
    /// another check of its name, if there is one.
    void release(const Names& names);
    void count_success(const Names& names);
    void forgive(std::string_view source, std::string_view user);
    void remember(std::string_view user, std::string_view source);

    const ServerLimits* limits_;
    std::vector<Source> sources_;
    /// By user name, for all sources.
    std::vector<Count> users_;
    /// The oldest first.
    std::vector<Success> known_good_;
};

/// Returns the network that an address counts for: "2001:db8:1:2::/64" for any host in it, an IPv4
/// address unchanged, also when it is written as IPv6.
[[nodiscard]] std::string network_of(std::string_view address);

} // namespace busbar::server::detail
