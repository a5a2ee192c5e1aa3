#pragma once

#include <optional>
#include <utility>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/secret.hpp>

#include "conversation.hpp"
#include "event_queue.hpp"
#include "refusals.hpp"
#include "symmetric_chunk.hpp"

namespace busbar::channel::detail {

/// Processes input at both ends of a connection: handles frames until one has produced an event,
/// there is no complete one or the channel is closed. A refused frame ends the channel.
template <typename Impl>
[[nodiscard]] std::optional<ChannelEvent> next_event_of(Impl& impl)
{
    while (impl.events.empty() && impl.state != decltype(impl.state)::Closed) {
        const auto frame = impl.conversation.next_frame();
        if (!frame) {
            impl.give_up(protocol_refusal(frame.error()));
        } else if (!*frame) {
            break;
        } else if (const auto handled = impl.handle(**frame); !handled) {
            impl.give_up(handled.error());
        }
    }
    return impl.events.pop();
}

/// Adds an opened chunk to its message and returns the event if that is complete or was aborted.
/// Decrypted content of the frame is overwritten, since the buffer is used again.
[[nodiscard]] inline Checked<std::optional<ChannelEvent>>
add_chunk(Conversation& conversation, const Frame& frame, const SymmetricContent& content)
{
    auto event = conversation.assembly().add(frame.header.chunk, content);
    if (is_encrypted(conversation.security)) {
        crypto::cleanse(frame.bytes);
    }
    if (!event) {
        return refuse(protocol_refusal(event.error()));
    }
    return *std::move(event);
}

} // namespace busbar::channel::detail
