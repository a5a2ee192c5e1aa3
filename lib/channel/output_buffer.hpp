#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include <busbar/channel/spare_buffers.hpp>
#include <busbar/core/api.hpp>

namespace busbar::channel::detail {

/// Outgoing bytes in one growing block. Chunks are created in place at its end.
///
/// With SpareBuffers the block is theirs: it is borrowed when there is something to send and
/// returned when all of it was taken, or when another buffer needs it. Without them the block is
/// reused, so that a connection in steady use does not allocate. Neither copied nor moved.
class OutputBuffer {
public:
    /// `spares` may be null, and must outlive the buffer.
    explicit OutputBuffer(SpareBuffers* spares = nullptr) : spares_{spares} {}
    OutputBuffer(const OutputBuffer&) = delete;
    OutputBuffer& operator=(const OutputBuffer&) = delete;
    BUSBAR_API ~OutputBuffer();

    /// Returns the output up to a gap.
    [[nodiscard]] std::span<const std::byte> output() const
    {
        return {block_.bytes.get() + begin_, gap_ ? *gap_ - consumed_ : end_ - begin_};
    }
    /// Size including the output after a gap.
    [[nodiscard]] std::size_t size() const { return end_ - begin_; }
    void consume(std::size_t size);

    /// Returns room for `size` bytes after the end, valid until the next reserve().
    [[nodiscard]] std::span<std::byte> reserve(std::size_t size);
    /// Makes the first `size` bytes of the room part of the output.
    void commit(std::size_t size) { end_ += size; }
    /// Positions count the bytes that were ever committed and not rolled back.
    [[nodiscard]] std::size_t position() const { return consumed_ + end_ - begin_; }
    /// Removes what was committed after `position`, none of which may have been consumed.
    void roll_back(std::size_t position);

    /// Leaves a gap, one at a time, for a message that is not ready yet: later output waits after
    /// it.
    void open_gap() { gap_ = position(); }
    /// Puts the message into the gap.
    void fill_gap(std::span<const std::byte> message);
    /// Removes the gap, if there is one, and the output after it.
    void drop_gap();
    /// Bytes that it holds, including a block of its SpareBuffers.
    [[nodiscard]] std::size_t capacity() const { return block_.size; }
    /// Maximum that it holds if there are never more than `output` bytes of output and no more than
    /// `room` are reserved at once.
    [[nodiscard]] static constexpr std::size_t max_capacity(std::size_t output, std::size_t room)
    {
        return output + output / 2 + room;
    }

    /// Called by the SpareBuffers when another buffer needs the block: moves the output to memory
    /// of its size, and returns the block. Returns none if it is not much larger than its content,
    /// or if there is no memory; then it belongs to this buffer.
    [[nodiscard]] Block leave_block();

private:
    void shrink_if_idle();
    void move_to(std::byte* front);
    void grow(std::size_t size, std::size_t needed);

    SpareBuffers* spares_;
    Block block_;
    std::size_t begin_{0};
    std::size_t end_{0};
    std::size_t consumed_{0};
    std::optional<std::size_t> gap_; // a position
};

} // namespace busbar::channel::detail
