#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <busbar/binary/writer.hpp>

#include "value_queue.hpp"

namespace busbar::server::detail {

/// The NotificationMessages that a client may request again, until it acknowledges them (Part 4,
/// 5.14.1.1): as the bytes that were sent, which are fewer than the values and need no second
/// encoding.
class RetransmissionQueue {
public:
    /// `account` pays for the messages.
    RetransmissionQueue(std::size_t max_messages, MemoryAccount& account)
        : max_messages_{max_messages}, account_{&account}
    {
    }
    RetransmissionQueue(const RetransmissionQueue&) = delete;
    RetransmissionQueue& operator=(const RetransmissionQueue&) = delete;
    ~RetransmissionQueue() { clear(); }

    /// Makes sure that add() needs no memory: called before the items' Notifications are taken.
    void make_place();
    /// Takes the message over, after make_place(). The oldest messages give way to it; if it cannot
    /// be paid for even so, it stays with the caller and is not kept. Returns how many were lost by
    /// that before they were acknowledged.
    std::uint32_t add(std::uint32_t sequence_number, std::vector<std::byte>& message);
    /// Returns false if there is no such message.
    [[nodiscard]] bool acknowledge(std::uint32_t sequence_number);
    /// Returns null if there is no such message.
    [[nodiscard]] const std::vector<std::byte>* find(std::uint32_t sequence_number) const;
    /// Writes availableSequenceNumbers.
    void encode_available(binary::Writer& writer) const;
    [[nodiscard]] std::vector<std::uint32_t> available() const;
    [[nodiscard]] std::size_t size() const { return messages_.size(); }
    void clear();

private:
    struct Message {
        std::uint32_t sequence_number;
        std::vector<std::byte> bytes;
    };

    void drop_oldest();

    std::size_t max_messages_;
    MemoryAccount* account_;
    /// The oldest first.
    std::vector<Message> messages_;
};

} // namespace busbar::server::detail
