#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::channel {

namespace detail {

class OutputBuffer;

/// Bytes that are not initialised until something is written there.
struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size{0};
};

} // namespace detail

/// Large buffers that the channels of one server use in turn: each holds no more than its content
/// needs, and still none allocates for every message. One buffer is for the message that is being
/// processed, one for the next large message, one for output. A channel whose peer does not take
/// its output keeps it in memory of its size once another channel needs the buffer.
///
/// In addition there is one block from the beginning, for a chunk when there is no memory, so that
/// the peer can be told. Must outlive the channels. One thread.
class BUSBAR_API SpareBuffers {
public:
    /// A larger buffer is freed and not kept.
    static constexpr std::size_t max_kept = 1U << 20U;

    /// `chunk_size`: the largest chunk that a channel sends, in bytes; 0 for the default.
    explicit SpareBuffers(std::size_t chunk_size = 0);
    SpareBuffers(const SpareBuffers&) = delete;
    SpareBuffers& operator=(const SpareBuffers&) = delete;
    ~SpareBuffers();

    /// Bytes that are kept for the next use; those that a channel holds are not counted.
    [[nodiscard]] std::size_t kept() const;

    // Used by the channels.

    /// Returns a buffer of at least `least` bytes for the output of `to`, of `wanted` if it has to
    /// be allocated. Throws std::bad_alloc if there is none.
    [[nodiscard]] detail::Block lend(detail::OutputBuffer& to, std::size_t least,
                                     std::size_t wanted);
    [[nodiscard]] bool is_lent_to(const detail::OutputBuffer& buffer) const
    {
        return holder_ == &buffer;
    }
    /// Takes `block` back: `from` has no output any more, or has it elsewhere.
    void give_back(detail::OutputBuffer& from, detail::Block block);

    /// Returns an empty vector of any capacity.
    [[nodiscard]] std::vector<std::byte> take_input();
    /// Takes the vector for another take_input().
    void give_back_input(std::vector<std::byte> input);
    /// Returns an empty vector whose buffer is not much larger than `size`.
    [[nodiscard]] std::vector<std::byte> take_message(std::size_t size);
    /// Returns `message` itself, or a copy without spare capacity if its buffer is much larger.
    [[nodiscard]] std::vector<std::byte> fitted(std::vector<std::byte> message);
    /// Takes the vector for another take_message().
    void give_back_message(std::vector<std::byte> message);

private:
    std::size_t chunk_size_;
    /// The owner of the output in the buffer; null if the buffer is here or unused.
    detail::OutputBuffer* holder_{nullptr};
    detail::Block output_;
    detail::Block last_resort_;
    std::vector<std::byte> input_;
    std::vector<std::byte> message_;
};

} // namespace busbar::channel
