#include "buffer_bounds.hpp"

#include <algorithm>

#include <busbar/channel/spare_buffers.hpp>

#include "frame.hpp"
#include "output_buffer.hpp"

namespace busbar::channel::detail {

namespace {

/// Returns the size of a message on the wire, with headers, signature and padding of its chunks.
std::size_t sealed_size(const TransportLimits& limits)
{
    constexpr std::size_t overhead = 256;
    const std::size_t chunks = limits.max_message_size / (limits.send_buffer_size - overhead) + 1;
    return limits.max_message_size +
           std::min<std::size_t>(chunks, limits.max_chunk_count) * overhead;
}

} // namespace

TransportLimits completed(TransportLimits limits)
{
    constexpr TransportLimits defaults;
    const auto size = [](std::uint32_t given, std::uint32_t standard) {
        return given == 0 ? standard : std::max(given, min_buffer_size);
    };
    limits.receive_buffer_size = size(limits.receive_buffer_size, defaults.receive_buffer_size);
    limits.send_buffer_size = size(limits.send_buffer_size, defaults.send_buffer_size);
    if (limits.max_message_size == 0) {
        limits.max_message_size = defaults.max_message_size;
    }
    if (limits.max_chunk_count == 0) {
        limits.max_chunk_count = defaults.max_chunk_count;
    }
    return limits;
}

BufferBounds bounds_of(const TransportLimits& given, std::size_t queue)
{
    const TransportLimits limits = completed(given);
    const std::size_t chunk = std::max(limits.receive_buffer_size, max_early_size);
    const std::size_t room = std::max(limits.send_buffer_size, max_early_size);
    BufferBounds bounds;
    // The same amount again may be processed and not yet moved away, and a growing vector doubles.
    bounds.input = 2 * (2 * chunk + max_fed_size);
    bounds.output = OutputBuffer::max_capacity(queue + sealed_size(limits), room);
    bounds.kept = std::min(2 * std::size_t{limits.max_message_size}, max_recycled_size);
    bounds.shared = std::min(bounds.input, SpareBuffers::max_kept) +
                    std::min(bounds.output, SpareBuffers::max_kept) + bounds.kept + room;
    return bounds;
}

} // namespace busbar::channel::detail
