#pragma once

#include <cstdint>

#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"

namespace busbar::channel::detail {

/// Tells the log of a token that was issued: the channel is new, or renewed (Part 5, 6.4.5 to
/// 6.4.7).
void record_issued(const Conversation& conversation, std::uint32_t channel_id,
                   const OpenSecureChannelRequest& request, bool is_new);

} // namespace busbar::channel::detail
