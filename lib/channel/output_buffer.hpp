#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include <busbar/channel/spare_buffers.hpp>
#include <busbar/core/api.hpp>

namespace busbar::channel::detail {

/// Bytes on their way out, in one growing block. Chunks are made in place at its end.
///
/// With SpareBuffers the block is theirs: it comes when there is something to send and goes when
/// all of it was taken, or when another needs it. Without them the block is reused, so that a
/// connection in steady use does not allocate. Neither copied nor moved.
class OutputBuffer {
public:
    /// `spares` may be null, and must outlive the buffer.
    explicit OutputBuffer(SpareBuffers* spares = nullptr) : spares_{spares} {}
    OutputBuffer(const OutputBuffer&) = delete;
    OutputBuffer& operator=(const OutputBuffer&) = delete;
    BUSBAR_API ~OutputBuffer();

    /// Nothing behind a gap.
    [[nodiscard]] std::span<const std::byte> output() const
    {
        return {block_.bytes.get() + begin_, gap_ ? *gap_ - consumed_ : end_ - begin_};
    }
    /// With what is behind a gap.
    [[nodiscard]] std::size_t size() const { return end_ - begin_; }
    void consume(std::size_t size);

    /// Room for `size` bytes behind the end, valid until the next reserve().
    [[nodiscard]] std::span<std::byte> reserve(std::size_t size);
    /// Makes the first `size` bytes of the room part of the output.
    void commit(std::size_t size) { end_ += size; }
    /// Positions count the bytes ever committed and not rolled back.
    [[nodiscard]] std::size_t position() const { return consumed_ + end_ - begin_; }
    /// Takes back what was committed after `position`, none of which may have been consumed.
    void roll_back(std::size_t position);

    /// Leaves a place, one at a time, for a message that is not made yet: what is committed from
    /// now on waits behind it.
    void open_gap() { gap_ = position(); }
    /// Puts the message there.
    void fill_gap(std::span<const std::byte> message);
    /// Takes back the place, if there is one, and what waits behind it.
    void drop_gap();
    /// Bytes that it holds, the block of its SpareBuffers included while it has that.
    [[nodiscard]] std::size_t capacity() const { return block_.size; }
    /// The most that it holds if there are never more than `output` bytes of output and no more
    /// than `room` are reserved at once.
    [[nodiscard]] static constexpr std::size_t max_capacity(std::size_t output, std::size_t room)
    {
        return output + output / 2 + room;
    }

    /// For the SpareBuffers, as another needs the block: moves what there is to memory of its size,
    /// and gives the block. None if it is not much larger than what is in it, or if there is no
    /// memory; then it is this buffer's own.
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
