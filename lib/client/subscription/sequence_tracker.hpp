#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <busbar/types/subscription.hpp>

namespace busbar::client::detail {

/// Puts the NotificationMessages of one Subscription into the order of their sequence numbers, and
/// tells which one is missing (Part 4, 5.14.1.1: they count from 1 and go on with 1 after
/// 4,294,967,295).
class SequenceTracker {
public:
    enum class Arrival : std::uint8_t {
        Kept,      // until it is its turn
        Duplicate, // taken before
        Repeated,  // kept already
        TooFar,    // more than `max_missing` are between; not kept
    };

    explicit SequenceTracker(std::size_t max_missing) : max_missing_{max_missing} {}

    /// Moves from `message` if it is kept.
    Arrival put(NotificationMessage& message);
    /// The message whose turn it is, if it is here.
    [[nodiscard]] std::optional<NotificationMessage> take();

    /// All numbers before `sequence_number` have been sent. False if more than `max_missing` of
    /// them would be missing; the number is not believed then.
    bool expect_before(std::uint32_t sequence_number);
    /// The same of the numbers up to this one.
    bool expect_through(std::uint32_t sequence_number);
    /// The next message was sent, as far as is known, and is not here.
    [[nodiscard]] bool is_missing() const;
    /// Gives the next message up.
    void skip();
    /// Goes on with `sequence_number`; what is kept is dropped.
    void restart(std::uint32_t sequence_number);
    /// As made: another Subscription, which counts from 1.
    void reset() { *this = SequenceTracker{max_missing_}; }

    /// The sequence number of the next message.
    [[nodiscard]] std::uint32_t next() const { return next_; }
    [[nodiscard]] std::size_t kept_count() const { return kept_.size(); }
    [[nodiscard]] std::size_t max_missing() const { return max_missing_; }

private:
    /// How far ahead of the next number this is; nothing if it is behind or no sequence number.
    [[nodiscard]] std::optional<std::uint32_t> distance_to(std::uint32_t sequence_number) const;

    std::size_t max_missing_;
    std::uint32_t next_{1};
    // Positions count on where sequence numbers begin again.
    std::uint64_t position_{0};
    std::uint64_t end_{0}; // behind the last message that is known of
    std::map<std::uint64_t, NotificationMessage> kept_;
};

} // namespace busbar::client::detail
