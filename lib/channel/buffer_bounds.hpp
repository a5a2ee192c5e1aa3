#pragma once

#include <cstddef>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>

namespace busbar::channel::detail {

/// An idle connection does not keep more for its input.
inline constexpr std::size_t max_idle_input = 256U << 10U;
/// A larger buffer is not worth keeping for the next message.
inline constexpr std::size_t max_recycled_size = 1U << 20U;
/// What an owner is expected to feed at once; it has no use for larger reads.
inline constexpr std::size_t max_fed_size = 65'536;

/// The limits with the default in place of each that is not given.
[[nodiscard]] BUSBAR_API TransportLimits completed(TransportLimits limits);

/// Bytes that the buffers of one connection hold at most.
struct BufferBounds {
    /// What came and is no whole chunk yet. For an owner who feeds max_fed_size bytes at most, and
    /// only once all chunks before them were worked on.
    std::size_t input{0};
    /// What waits for the peer.
    std::size_t output{0};
    /// The buffer that is kept for the next message; one that is being put together is charged to
    /// the AssemblyBudget. Of one without SpareBuffers.
    std::size_t kept{0};
    /// What SpareBuffers hold beside all that.
    std::size_t shared{0};
};
/// `queue` is how much output there may be before another message is sent.
[[nodiscard]] BUSBAR_API BufferBounds bounds_of(const TransportLimits& limits, std::size_t queue);

} // namespace busbar::channel::detail
