#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <busbar/types/subscription.hpp>

namespace busbar::test {

/// Whether the numbers that an item brings are all there, once and in order.
class CountCheck {
public:
    /// The next number may be any that is not smaller: something happened that may have lost
    /// numbers, or repeats the last one.
    void allow_gap() { ++gaps_; }
    /// The server told of a loss right before the next number.
    void tell_overflow() { is_overflow_ = true; }
    /// False if the number must not come now.
    [[nodiscard]] bool receive(std::int64_t number);
    [[nodiscard]] std::optional<std::int64_t> last() const { return last_; }
    /// A gap that was allowed has not come yet.
    [[nodiscard]] bool may_miss() const { return gaps_ != 0; }

private:
    std::optional<std::int64_t> last_;
    unsigned gaps_{0};
    bool is_overflow_{false};
};

/// Whether the messages of a Subscription are all there: puts them into the order of their numbers
/// and knows which one to ask for again (Part 4, 5.14.1.1 and 7.8).
class SequenceCheck {
public:
    /// `kept` is how many messages the server keeps for Republish.
    explicit SequenceCheck(std::uint32_t kept) : kept_{kept} {}

    /// A message with Notifications, asked for again or not. False if it came already.
    [[nodiscard]] bool receive(NotificationMessage message);
    /// A keep-alive bears the number of the message that comes next. False if that one came
    /// already.
    [[nodiscard]] bool receive_keep_alive(std::uint32_t number);
    /// TransferSubscriptions told of these messages.
    void receive_available(const Array<std::uint32_t>& numbers);
    /// The message whose turn it is; none if it is not there.
    [[nodiscard]] std::optional<NotificationMessage> take();

    /// The next message was sent and did not arrive.
    [[nodiscard]] bool has_gap() const { return next_ <= highest_ && !waiting_.contains(next_); }
    [[nodiscard]] std::uint32_t next() const { return next_; }
    /// The largest number that is known to have been sent.
    [[nodiscard]] std::uint32_t highest() const { return highest_; }
    /// The server has not got the next message any more. It is given up.
    void give_up();
    /// False if a message was given up which the server should have had: when the response after
    /// that came, there were not as many newer ones as it keeps.
    [[nodiscard]] bool was_loss_allowed();

private:
    std::uint32_t kept_;
    std::uint32_t next_{1};
    std::uint32_t highest_{0};
    std::uint32_t must_reach_{0};
    std::map<std::uint32_t, NotificationMessage> waiting_;
};

} // namespace busbar::test
