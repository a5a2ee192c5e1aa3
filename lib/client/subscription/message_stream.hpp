#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <busbar/core/clock.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/status_code.hpp>

#include "sequence_tracker.hpp"

namespace busbar::client::detail {

/// Why notifications are missing and since when; becomes a Gap with the next notification.
struct Loss {
    StatusCode reason;
    DateTime from;
};

/// The messages of one Subscription: which of them came, which are to be asked for again, and by
/// when the next one has to be here. It sends nothing and calls nobody.
struct MessageStream {
    explicit MessageStream(std::size_t max_missing) : sequence{max_missing} {}

    /// A message came that the server made at `time`, null if none ever did; the next one has to
    /// come within one and a half keep-alive intervals and what a slow link may take.
    void heard(DateTime time, TimePoint now);
    /// Nothing came in time: probes for messages, and waits as long again. How often that was so
    /// since the last message.
    std::uint32_t fall_silent(TimePoint now);
    /// Notifications after complete_until are lost. What was lost earlier keeps its reason.
    void lose(StatusCode reason);

    /// A session began: nothing was asked for in it.
    void begin_session();
    /// The Subscription lives on in this session: what the server has kept is asked for first.
    void catch_up(TimePoint now);
    /// The session ended: requests under way have no answers.
    void interrupt();
    /// The Subscription is made anew and counts from 1. What is told of is not forgotten.
    void restart();

    /// True if Republish is needed. Ends the catching up if it is not.
    bool needs_republish();
    /// A message came by Republish. A server that never ends is not probed for ever.
    void republished();

    SequenceTracker sequence;
    bool is_republishing{false};
    /// Republish shall tell whether there is more than is known of.
    bool is_probing{false};
    /// Since the session began it was not yet brought up to date; nothing is published meanwhile.
    bool is_catching_up{false};
    std::size_t probe_count{0};
    std::uint32_t republish_failures{0};
    TimePoint republish_at{};
    Duration keep_alive_interval{0};
    TimePoint silent_at{no_deadline};
    std::uint32_t silences{0};
    /// Since the last message or silence the server has answered a Republish that it has none.
    bool is_server_alive{false};
    DateTime heard_time;     // of the last message
    DateTime complete_until; // null before the first message
    std::optional<Loss> loss;
};

} // namespace busbar::client::detail
