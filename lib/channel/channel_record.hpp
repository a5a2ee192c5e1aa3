#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"

namespace busbar::channel::detail {

/// Records an issued token: the channel is new, or renewed (Part 5, 6.4.5 to 6.4.7).
void record_issued(const Conversation& conversation, std::uint32_t channel_id,
                   const OpenSecureChannelRequest& request, bool is_new);

/// Records that the client closed the channel (Part 4, 6.5.5), with this encoded
/// CloseSecureChannelRequest.
void record_closed(const Conversation& conversation, std::uint32_t channel_id,
                   std::span<const std::byte> request);

} // namespace busbar::channel::detail
