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

/// What both ends of a connection do with what comes in: handles frames until one has made an
/// event, there is no whole one or the channel is closed. What a frame is refused for ends it.
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

/// Adds a chunk that was opened to its message: the event if that is complete or was given up. What
/// was decrypted in the frame is overwritten: the buffer stays for what comes next.
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
