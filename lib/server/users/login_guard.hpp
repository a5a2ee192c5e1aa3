#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server::detail {

/// Who tries to log in, and from where.
struct LoginAttempt {
    /// As the token says it; empty for tokens without a password.
    std::string_view user;
    /// Thumbprint of the client's certificate; empty without security.
    std::string_view certificate;
    std::string_view address;
    /// See UserStore::has_code.
    bool has_code{false};
};

/// Makes guessing slow, then impossible for a while (Part 4, 5.7.3.1), in a way that nobody can
/// turn against others.
///
/// - A *source* is a client's certificate, without one the network it comes from: an IPv4 address
/// or
///   the /64 of an IPv6 address. The clients with certificates of one network are a second source
///   for each of them, so that new certificates do not help. Failures are counted for each source
///   and, within it, for each user name.
/// - **Delay**: from a source's second failure on, answers wait, each twice as long as the one
///   before.
/// - **Lock-out** is of one user at one source, after max_login_failures; and of a source for all
///   users, after max_login_failures_per_source. Nobody is ever locked out by what others do
///   elsewhere.
/// - **Known good**: who has logged in from a source before is not bound by the source's lock, only
///   by his own there. A success forgives the user's failures at that source and no one else's, so
///   that an own account does not help to guess at others'.
/// - **Slow-down**: a name that fails at many sources is guessed at by many. Logins with it are
///   looked at a bounded time later, but for the known good ones.
///
/// - **At the same time**: no more checks are under way than may fail before a lock-out. The next
///   one waits for an end of these, so that many guesses at once bring no more than one after the
///   other, and many right logins at once are all let in.
///
/// - **Codes**: the name of a random code, which cannot be guessed, is not counted for the network
///   and not bound by its lock, so that strangers do not keep out whoever has the code. They are
///   slowed down as above.
///
/// Memory is bounded, and no flood washes out what counts: one source has one record with a bounded
/// number of names, and past those its failures still count for the source. A full table lets the
/// entry with the fewest failures go, and never one with more than a single failure; if there is
/// none, the newcomer gets no record, and what has no record is slowed down as if it were guessed
/// at. Successes are remembered in a table of their own, which takes a password to fill.
///
/// What this cannot tell apart are clients without a certificate at one address.
class LoginGuard {
public:
    explicit LoginGuard(const ServerLimits& limits) : limits_{&limits} {}

    struct Admission {
        /// Refuse without looking at the password.
        bool is_locked{false};
        /// Ask again when a check has ended: if all that are under way are wrong, it is locked.
        bool has_to_wait{false};
        /// How long to wait before looking at it, or before refusing.
        Duration delay{Duration::zero()};
    };
    [[nodiscard]] Admission admit(const LoginAttempt& attempt, TimePoint now) const;
    /// Counts a failure of an attempt that was admitted; returns how long its answer has to wait.
    [[nodiscard]] Duration failed(const LoginAttempt& attempt, TimePoint now);
    /// The attempt was right.
    void succeeded(const LoginAttempt& attempt);

    /// How a check ended that takes its time.
    enum class End : std::uint8_t { Right, Wrong, NotLookedAt };
    /// The check of an attempt that was admitted is under way, until ended() is called with the
    /// same attempt. Returns how long its answer has to wait if it is wrong.
    [[nodiscard]] Duration begun(const LoginAttempt& attempt, TimePoint now);
    void ended(const LoginAttempt& attempt, End end, TimePoint now);

    /// Who that is for the rationing of what logins cost: the client's certificate, without one
    /// its network.
    [[nodiscard]] static std::string source_of(const LoginAttempt& attempt);
    /// Somebody has logged in from there.
    [[nodiscard]] bool knows(std::string_view source) const;

    /// Entries of all tables, for tests.
    [[nodiscard]] std::size_t size() const
    {
        return sources_.size() + users_.size() + known_good_.size();
    }

private:
    struct Count {
        /// What it may come to.
        [[nodiscard]] std::size_t most() const { return failures + checks; }

        std::string name;
        /// That are not forgiven yet.
        std::size_t failures{0};
        /// That are under way.
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
    /// The names of the sources that an attempt counts for; the first is the more exact one.
    struct Names {
        std::string first;
        std::string second; // empty without a certificate and for a code
    };

    [[nodiscard]] static Names source_names(const LoginAttempt& attempt);
    /// True if a new entry would find a place.
    template <typename Entry>
    [[nodiscard]] bool has_place(const std::vector<Entry>& table, std::size_t most,
                                 TimePoint now) const;
    template <typename Entry>
    [[nodiscard]] const Entry* find(const std::vector<Entry>& table, std::string_view name,
                                    TimePoint now) const;
    /// The entry, a new one if it is not there; null if there is no place for it.
    template <typename Entry>
    [[nodiscard]] Entry* count_in(std::vector<Entry>& table, std::string_view name,
                                  std::size_t most, TimePoint now) const;
    [[nodiscard]] bool is_forgiven(const Count& count, TimePoint now) const;
    [[nodiscard]] bool is_known_good(std::string_view user, std::string_view source) const;
    /// By the failures alone, or else by the checks that are under way.
    [[nodiscard]] static Admission admission(const Count* count, std::size_t most, Duration delay);
    /// Returns what limits this user at the source, or every user there.
    [[nodiscard]] Admission admit_user(std::string_view source, std::string_view user,
                                       TimePoint now) const;
    [[nodiscard]] Admission admit_source(std::string_view source, TimePoint now) const;
    [[nodiscard]] Duration slow_down(const LoginAttempt& attempt, const Names& names,
                                     TimePoint now) const;
    [[nodiscard]] Duration delay_after(std::size_t failures) const;
    /// Counts one more of a kind wherever the attempt counts; returns how many failures the first
    /// source has then, if all its checks are wrong.
    std::size_t count(const LoginAttempt& attempt, std::size_t Count::*kind, TimePoint now);
    std::size_t count_at(std::string_view source, std::string_view user, std::size_t Count::*kind,
                         TimePoint now);
    /// A check is not under way any more.
    void release(const LoginAttempt& attempt);
    void forgive(std::string_view source, std::string_view user);
    void remember(std::string_view user, std::string_view source);

    const ServerLimits* limits_;
    std::vector<Source> sources_;
    /// By user name, of all sources.
    std::vector<Count> users_;
    /// The oldest in front.
    std::vector<Success> known_good_;
};

/// The network that an address counts for: "2001:db8:1:2::/64" for any host in it, an IPv4 address
/// as it is, also when it is written as IPv6.
[[nodiscard]] std::string network_of(std::string_view address);

} // namespace busbar::server::detail
