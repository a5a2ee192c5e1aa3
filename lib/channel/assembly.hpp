#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <busbar/channel/channel_types.hpp>

#include "frame.hpp"
#include "symmetric_chunk.hpp"

namespace busbar::channel::detail {

/// Joins the chunks of messages, one message after the other (Part 6, 6.7.2 and 6.7.3).
///
/// The size of an unfinished message is limited and charged to the budget.
class Assembly {
public:
    /// `budget` and `spares` may be null.
    Assembly(const TransportLimits& limits, AssemblyBudget* budget, SpareBuffers* spares = nullptr)
        : most_{limits.max_message_size}, max_message_size_{limits.max_message_size},
          max_chunk_count_{limits.max_chunk_count}, budget_{budget}, spares_{spares}
    {
    }
    Assembly(const Assembly&) = delete;
    Assembly& operator=(const Assembly&) = delete;
    ~Assembly() { drop(); }

    /// Adds a verified chunk. Returns the event when it ends a message: Message, or Aborted with
    /// the sender's status. Bad_TcpMessageTypeInvalid for a chunk of another message in between,
    /// Bad_TcpMessageTooLarge past a limit, Bad_TcpNotEnoughResources past the budget.
    [[nodiscard]] Result<std::optional<ChannelEvent>> add(char flag,
                                                          const SymmetricContent& content);
    /// Sets the maximum size of messages from now on, including the present one; never more than
    /// the initial limits.
    void limit_messages(std::uint32_t size) { max_message_size_ = std::min(size, most_); }
    /// True while a message is unfinished.
    [[nodiscard]] bool has_begun() const { return chunks_ != 0; }
    /// Bytes of the unfinished message.
    [[nodiscard]] std::size_t unfinished_size() const { return charged_; }
    /// Discards the unfinished message, which will never be finished.
    void end()
    {
        drop();
        message_ = {};
    }
    /// Takes a buffer in which the next message is joined.
    void recycle(std::vector<std::byte> buffer);
    [[nodiscard]] std::size_t capacity() const { return message_.capacity(); }

private:
    [[nodiscard]] ChannelEvent give_up(const SymmetricContent& content);
    [[nodiscard]] bool charge(std::size_t size);
    void begin(char flag, std::size_t size);
    [[nodiscard]] std::vector<std::byte> take_message();
    void drop();

    std::uint32_t most_;
    std::uint32_t max_message_size_;
    std::uint32_t max_chunk_count_;
    AssemblyBudget* budget_;
    SpareBuffers* spares_;
    std::vector<std::byte> message_;
    std::size_t charged_{0};
    std::uint32_t request_id_{0};
    std::uint32_t chunks_{0};
};

} // namespace busbar::channel::detail
