#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/open_gate.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server::detail {

/// A bucket of tokens, seen as the time until which they are spent.
struct TokenBucket {
    /// How long to wait for a token where `burst` of them, at least one, may be spent at once and a
    /// new one comes each `interval`.
    [[nodiscard]] Duration wait(std::size_t burst, Duration interval, TimePoint now) const;
    /// Spends one that costs `interval`, also before its time.
    void spend(Duration interval, TimePoint now);

    TimePoint spent_until{};
};

/// Rations by the peer's address what OpenSecureChannel costs a server (Part 2, 5.1.2.2): the
/// sender of a message, whether new or overheard and sent again, has no work with it, the server
/// has some milliseconds of its private key's.
///
/// - A *source* is an IPv4 address or the /64 of an IPv6 address. Each has max_channel_burst tokens
///   and gets one each channel_interval; what finds none waits for it, in the order of arrival.
/// - What would wait longer than max_channel_delay is refused at once.
/// - **Failures** make a source wait failed_channel_interval for each request, from the
///   max_channel_failures-th on. One is forgiven in each of these intervals; no more than twice
///   max_channel_failures are counted, so that a source is as good as new soon after it has
///   stopped.
/// - **A channel that works** gives back what it cost and forgives all failures of its source. That
///   it works shows in its first message, which takes the keys: to open it takes an overheard
///   request only.
///
/// Times of nothing ration nothing. What this cannot tell apart are peers at one address; that is
/// why a renewal is none of its business. Memory is bounded: the source that was seen least
/// recently makes room, and is new when it comes again.
class ChannelGuard {
public:
    /// With limits that check_config lets pass.
    explicit ChannelGuard(const ServerLimits& limits) : limits_{&limits} {}

    struct Admission {
        bool is_admitted{true};
        /// Until it is worked on.
        Duration wait{Duration::zero()};
        /// What worked() gives back.
        Duration cost{Duration::zero()};
        /// Refused, as others of the same episode were: it ends when a request of that source has
        /// not to wait.
        bool is_known{false};
    };
    /// Of a request to open a channel that has no more than `longest` to wait. Source as
    /// network_of() names it.
    [[nodiscard]] Admission admit(std::string_view source, Duration longest, TimePoint now);
    /// An admitted request failed, or its channel ended without a message.
    void failed(std::string_view source, TimePoint now);
    void worked(std::string_view source, Duration cost);

    /// Sources that are remembered, for tests.
    [[nodiscard]] std::size_t size() const { return sources_.size(); }

private:
    struct Source {
        std::string name;
        TokenBucket bucket;
        std::size_t failures{0};
        /// Since when none of the failures was forgiven.
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

/// The guard as the channel of one connection sees it. A renewal is rationed by itself: a client
/// that asks no more often than its tokens' lifetime makes sensible never waits.
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
