#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/open_gate.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server::detail {

/// A token bucket, represented by the time until which its tokens are spent.
struct TokenBucket {
    /// Returns the time to wait for a token if `burst` of them, at least one, may be spent at once
    /// and a new one is added each `interval`.
    [[nodiscard]] Duration wait(std::size_t burst, Duration interval, TimePoint now) const;
    /// Spends one that costs `interval`, even before its time.
    void spend(Duration interval, TimePoint now);

    TimePoint spent_until{};
};

/// Limits by the peer's address what OpenSecureChannel costs a server (Part 2, 5.1.2.2): sending a
/// message, whether new or recorded and sent again, costs nothing, processing it takes the server's
/// private key some milliseconds.
///
/// - A *source* is an IPv4 address or the /64 of an IPv6 address. Each has max_channel_burst tokens
///   and gets one each channel_interval; a request that finds none waits for it, in the order of
///   arrival.
/// - A request that would wait longer than max_channel_delay is refused at once.
/// - **Failures** make a source wait failed_channel_interval for each request, from the
///   max_channel_failures-th on. One is forgiven in each of these intervals; no more than twice
///   max_channel_failures are counted, so that a source is as good as new soon after it has
///   stopped.
/// - **A channel that works** returns its cost and forgives all failures of its source. Its first
///   message proves that it works, since that needs the keys: opening it needs only a recorded
///   request.
///
/// Intervals of 0 mean no limit. It cannot tell peers at one address apart; that is why it does not
/// handle renewals. Memory is bounded: the source that was seen least recently makes room, and is
/// new when it returns.
class ChannelGuard {
public:
    /// The limits must have passed check_config.
    explicit ChannelGuard(const ServerLimits& limits) : limits_{&limits} {}

    struct Admission {
        bool is_admitted{true};
        /// The delay until it is processed.
        Duration wait{Duration::zero()};
        /// The cost that worked() returns.
        Duration cost{Duration::zero()};
        /// Refused, like others of the same episode, which ends when a request of this source does
        /// not have to wait.
        bool is_known{false};
    };
    /// Decides about a request to open a channel that may wait at most `longest`. `source` has the
    /// form of network_of().
    [[nodiscard]] Admission admit(std::string_view source, Duration longest, TimePoint now);
    /// An admitted request failed, or its channel ended without a message.
    void failed(std::string_view source, TimePoint now);
    void worked(std::string_view source, Duration cost);

    /// Number of remembered sources, for tests.
    [[nodiscard]] std::size_t size() const { return sources_.size(); }

private:
    struct Source {
        std::string name;
        TokenBucket bucket;
        std::size_t failures{0};
        /// The time since when no failure was forgiven.
        TimePoint counted;
        TimePoint seen;
        bool is_refused{false};
    };
    [[nodiscard]] Source* find(std::string_view name);
    [[nodiscard]] Source& find_or_add(std::string_view name, TimePoint now);
    void forgive_in_time(Source& source, TimePoint now) const;
    [[nodiscard]] bool is_failing(const Source& source) const;

    const ServerLimits* limits_;
    std::vector<Source> sources_;
};

/// The guard from the view of one connection's channel. Renewals are limited separately: a client
/// that renews no more often than its tokens' lifetime requires never waits.
class ConnectionGate final : public channel::OpenGate {
public:
    /// Both must outlive it.
    ConnectionGate(ChannelGuard& guard, const ServerLimits& limits, std::string_view address);

    [[nodiscard]] Admission admit(bool is_renewal, Duration longest, TimePoint now) override;
    void failed(TimePoint now) override { guard_.failed(source_, now); }
    void worked() override { guard_.worked(source_, cost_); }

private:
    ChannelGuard& guard_;
    const ServerLimits& limits_;
    std::string source_;
    Duration cost_{Duration::zero()};
    TokenBucket renewals_;
};

} // namespace busbar::server::detail
