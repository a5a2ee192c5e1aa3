#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <busbar/types/subscription.hpp>

namespace busbar::client::detail {

/// Sorts the NotificationMessages of one Subscription by their sequence numbers, and finds missing
/// ones (Part 4, 5.14.1.1: they count from 1 and continue with 1 after 4,294,967,295).
class SequenceTracker {
public:
    enum class Arrival : std::uint8_t {
        Kept,      // until it is its turn
        Duplicate, // taken before
        Repeated,  // kept already
        TooFar,    // more than `max_missing` are between; not kept
    };

    explicit SequenceTracker(std::size_t max_missing) : max_missing_{max_missing} {}

    /// True if the message with that number was taken before.
    [[nodiscard]] bool has_passed(std::uint32_t sequence_number) const
    {
        return !distance_to(sequence_number);
    }
    /// Moves from `message` if it is kept.
    Arrival put(NotificationMessage& message);
    /// Returns the next message, if it has arrived.
    [[nodiscard]] std::optional<NotificationMessage> take();

    /// All numbers before `sequence_number` have been sent. False if more than `max_missing` of
    /// them would be missing; the number is ignored then.
    bool expect_before(std::uint32_t sequence_number);
    /// The numbers up to and including this one have been sent.
    bool expect_through(std::uint32_t sequence_number);
    /// True if the next message was sent, as far as is known, and has not arrived.
    [[nodiscard]] bool is_missing() const;
    /// Gives up the next message.
    void skip();
    /// Continues with `sequence_number`; kept messages are dropped.
    void restart(std::uint32_t sequence_number);
    /// Starts again, for another Subscription, which counts from 1.
    void reset() { *this = SequenceTracker{max_missing_}; }

    /// The sequence number of the next message.
    [[nodiscard]] std::uint32_t next() const { return next_; }
    [[nodiscard]] std::size_t kept_count() const { return kept_.size(); }
    [[nodiscard]] std::size_t max_missing() const { return max_missing_; }

private:
    /// Returns how far this number is ahead of the next one; nothing if it is older or not a
    /// sequence number.
    [[nodiscard]] std::optional<std::uint32_t> distance_to(std::uint32_t sequence_number) const;

    std::size_t max_missing_;
    std::uint32_t next_{1};
    // Positions continue where sequence numbers begin again.
    std::uint64_t position_{0};
    std::uint64_t end_{0}; // after the last known message
    std::map<std::uint64_t, NotificationMessage> kept_;
};

} // namespace busbar::client::detail
