#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "load.hpp"
#include "process.hpp"

namespace busbar::bench {

/// What is done to a server while a client that means well reads from it.
struct HostileOptions {
    /// Bytes of a request with a header that becomes many times as large when it is decoded; less
    /// where the server says that it takes less.
    std::size_t bomb_size{16U << 20U};
    /// Connections with a session each that ask for Browses, how many nodes in one, and how many
    /// Browses each has under way.
    std::size_t connections{20};
    std::size_t nodes{100};
    std::size_t in_flight{50};
    double seconds{1};
    /// Instead of all that: how many attackers send an overheard OpenSecureChannel again and again,
    /// while the good client has a Subscription, too. At this machine their address is
    /// 127.0.0.2, or for each its own from there on.
    std::vector<std::size_t> replays;
    bool has_own_addresses{false};
    /// Or, instead of it, how many attackers take what is shared. The good client has a user, and
    /// more connections come and go beside it.
    std::vector<std::size_t> quotas;
    /// Or, instead of it, how many users who add users, change passwords and guess at them, while
    /// ten logins a second mean well.
    std::vector<std::size_t> passwords;
    /// Or what users of administration may call, many of each Method in one Call.
    bool is_administration{false};
    /// Who calls, with the password that all of them have.
    std::vector<std::string> callers;
    std::string password;
    std::optional<channel::ApplicationIdentity> identity;
    std::size_t calls{1'000};
    /// Of our own controller's program, or its labels.
    std::size_t variables{0};
    /// Or `busbar`, by which programs, backups and projects are sent to controllers of our own.
    std::string tool;
    /// What the server's thread had of a processor at a time, since it was asked last; may be
    /// empty.
    std::function<double()> take_longest_piece_ms;
    /// Our own server lets them.
    bool is_unrationed{false};
    /// It has a worker for them.
    bool has_worker{false};
    /// Whose memory is read; 0 for nobody's.
    pid_t server_process{0};
};

/// One attack, and what the good client saw meanwhile.
struct HostileRow {
    std::string attack;
    /// Requests that were answered as asked, and those that were refused, with or without a word.
    std::size_t answered{0};
    std::size_t refused{0};
    /// Of the good client: Reads, and those without a good answer.
    std::size_t reads{0};
    std::size_t failed{0};
    double median_us{0};
    double p90_us{0};
    double p99_us{0};
    double worst_us{0};
    /// Its notifications, if it has a Subscription, and the longest time between two of them.
    std::size_t publishes{0};
    double longest_gap_ms{0};
    /// Its further connections, from TCP to the session: those that came to be, those that did not,
    /// and the longest time of one.
    std::size_t logins{0};
    std::size_t failed_logins{0};
    double worst_login_ms{0};
    /// What of the attackers ended, well or not, while one login was waited for, at most.
    std::size_t most_before_login{0};
    /// How the first Method or login that did not end well ended; empty where there was none.
    std::string status;
    /// The longest piece of the server's work; 0 where it is not known.
    double longest_piece_ms{0};
    /// Of the server.
    Memory before;
    Memory after;

    [[nodiscard]] double growth_mb() const { return after.now_mb - before.now_mb; }
    [[nodiscard]] double peak_growth_mb() const { return after.peak_mb - before.now_mb; }
};

/// First nothing, then each attack for the time of the options. Fails where the good client gets
/// no connection, before, while or after the server is attacked.
[[nodiscard]] Result<std::vector<HostileRow>> attack(Load& load, const HostileOptions& options);

/// The Subscription that the good client has beside replays: the server's time each 50 ms.
[[nodiscard]] SubscribeOptions good_subscription(double seconds);

} // namespace busbar::bench
