#pragma once

#include <cstddef>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>

namespace busbar::channel::detail {

/// Maximum input buffer that an idle connection keeps.
inline constexpr std::size_t max_idle_input = 256U << 10U;
/// A larger buffer is not kept for the next message.
inline constexpr std::size_t max_recycled_size = 1U << 20U;
/// Maximum size that an owner is expected to feed at once; it need not read more.
inline constexpr std::size_t max_fed_size = 65'536;

/// Returns the limits with the default in place of each missing one.
[[nodiscard]] BUSBAR_API TransportLimits completed(TransportLimits limits);

/// Maximum sizes of the buffers of one connection, in bytes.
struct BufferBounds {
    /// Input that is not a whole chunk yet, if the owner feeds at most max_fed_size bytes at once,
    /// and only after all earlier chunks were processed.
    std::size_t input{0};
    /// Output that waits for the peer.
    std::size_t output{0};
    /// The buffer that is kept for the next message, without SpareBuffers; a message that is being
    /// joined is charged to the AssemblyBudget.
    std::size_t kept{0};
    /// Bytes that SpareBuffers hold in addition.
    std::size_t shared{0};
};
/// `queue` is the amount of output that may wait before another message is sent.
[[nodiscard]] BUSBAR_API BufferBounds bounds_of(const TransportLimits& limits, std::size_t queue);

} // namespace busbar::channel::detail
