#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace busbar::channel::detail {

/// Bytes on their way out: one growing block that is reused, so that a connection in steady use
/// does not allocate. Chunks are made in place at its end. Not copied.
class OutputBuffer {
public:
    [[nodiscard]] std::span<const std::byte> output() const
    {
        return {storage_.get() + begin_, end_ - begin_};
    }
    void consume(std::size_t size);

    /// Room for `size` bytes behind the end, valid until the next reserve().
    [[nodiscard]] std::span<std::byte> reserve(std::size_t size);
    /// Makes the first `size` bytes of the room part of the output.
    void commit(std::size_t size) { end_ += size; }
    /// Positions count the bytes ever committed and not rolled back.
    [[nodiscard]] std::size_t position() const { return consumed_ + end_ - begin_; }
    /// Takes back what was committed after `position`, none of which may have been consumed.
    void roll_back(std::size_t position);
    [[nodiscard]] std::size_t capacity() const { return capacity_; }
    /// The most that it holds if there are never more than `output` bytes of output and no more
    /// than `room` are reserved at once.
    [[nodiscard]] static constexpr std::size_t max_capacity(std::size_t output, std::size_t room)
    {
        return output + output / 2 + room;
    }

private:
    void shrink_if_idle();
    void move_to_front(std::byte* front);

    std::unique_ptr<std::byte[]> storage_;
    std::size_t capacity_{0};
    std::size_t begin_{0};
    std::size_t end_{0};
    std::size_t consumed_{0};
};

} // namespace busbar::channel::detail
