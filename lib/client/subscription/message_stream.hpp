#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <busbar/core/clock.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/status_code.hpp>

#include "sequence_tracker.hpp"

namespace busbar::client::detail {

/// The reason why notifications are missing and the time since when; becomes a Gap with the next
/// notification.
struct Loss {
    StatusCode reason;
    DateTime from;
};

/// The messages of one Subscription: those that arrived, those to be requested again, and the time
/// by which the next one must arrive. It sends nothing and calls no handlers.
struct MessageStream {
    explicit MessageStream(std::size_t max_missing) : sequence{max_missing} {}

    /// A message arrived that the server created at `time`, null if none ever did; the next one
    /// must arrive within one and a half keep-alive intervals and some time for a slow link.
    void heard(DateTime time, TimePoint now);
    /// Nothing arrived in time: probes for messages, and waits as long again. Returns how often
    /// that happened since the last message.
    std::uint32_t fall_silent(TimePoint now);
    /// Notifications after complete_until are lost. An earlier loss keeps its reason.
    void lose(StatusCode reason);

    /// A session began: no request was made in it yet.
    void begin_session();
    /// The Subscription continues in this session: messages that the server has kept are requested
    /// first.
    void catch_up(TimePoint now);
    /// The session ended: requests under way will not be answered.
    void interrupt();
    /// The Subscription is created again and counts from 1. A reported loss is not forgotten.
    void restart();

    /// Returns true if Republish is needed. Ends the catching up if it is not.
    bool needs_republish();
    /// A message arrived by Publish with the number of an earlier one. Returns true if it is one of
    /// several in a row, so that the server must count from elsewhere now.
    [[nodiscard]] bool is_renumbered(std::uint32_t number);
    /// A message arrived by Republish. A server that never ends is not probed for ever.
    void republished();

    SequenceTracker sequence;
    bool is_republishing{false};
    /// Republish shall tell whether there are more messages than known.
    bool is_probing{false};
    /// It was not brought up to date since the session began; nothing is published meanwhile.
    bool is_catching_up{false};
    std::size_t probe_count{0};
    std::uint32_t republish_failures{0};
    /// Published messages in a row with numbers of earlier ones, and the last number.
    std::uint32_t repeated_count{0};
    std::uint32_t repeated_number{0};
    TimePoint republish_at{};
    Duration keep_alive_interval{0};
    TimePoint silent_at{no_deadline};
    std::uint32_t silences{0};
    /// Since the last message or silence the server has answered a Republish that it has none.
    bool is_server_alive{false};
    /// Since the last message the server has answered something else.
    bool has_sign{false};
    DateTime heard_time;     // of the last message
    DateTime complete_until; // null before the first message
    std::optional<Loss> loss;
};

} // namespace busbar::client::detail
