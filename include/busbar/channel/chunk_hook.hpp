#pragma once

#include <cstddef>
#include <span>

#include <busbar/core/api.hpp>

namespace busbar::channel {

/// Sees the MSG and CLO chunks that a channel sends, and may change them: for test benches, whose
/// peers must be able to be wrong, and which show what is sent on secured channels. Null in every
/// product. Called by the thread of the channel; must not call the channel.
class BUSBAR_API ChunkHook {
public:
    ChunkHook() = default;
    ChunkHook(const ChunkHook&) = delete;
    ChunkHook& operator=(const ChunkHook&) = delete;
    virtual ~ChunkHook() = default;

    /// `chunk` is about to be signed and encrypted: message header, security header, sequence
    /// header and body (Part 6, 6.7.2), without padding and signature.
    virtual void sealing(std::span<std::byte> chunk) = 0;
    /// The same chunk as it is sent.
    virtual void sealed(std::span<std::byte> chunk) = 0;
};

} // namespace busbar::channel
