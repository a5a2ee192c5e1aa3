#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::channel {

namespace detail {

class OutputBuffer;

/// Bytes without a value until something is written there.
struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size{0};
};

} // namespace detail

/// Large buffers that the channels of one server use in turn: each holds no more than what is in
/// it, and still none allocates for every message. One buffer is for what came and is worked on,
/// one for the next large message, one for output. A channel whose peer does not take its output
/// goes on holding it in memory of its size once another needs the buffer.
///
/// Besides these there is one block from the beginning, for a chunk when there is no memory, so
/// that who asked can be told. Must outlive the channels. One thread.
class BUSBAR_API SpareBuffers {
public:
    /// What is larger is given back to the system, and not kept.
    static constexpr std::size_t max_kept = 1U << 20U;

    /// `chunk_size`: the largest chunk that a channel sends, in bytes; 0 for the default.
    explicit SpareBuffers(std::size_t chunk_size = 0);
    SpareBuffers(const SpareBuffers&) = delete;
    SpareBuffers& operator=(const SpareBuffers&) = delete;
    ~SpareBuffers();

    /// Bytes that are kept for whoever needs them next; what a channel holds is its own matter.
    [[nodiscard]] std::size_t kept() const;

    // For the channels.

    /// A buffer of at least `least` bytes for the output of `to`, of `wanted` if it has to be
    /// allocated. Throws std::bad_alloc if there is none.
    [[nodiscard]] detail::Block lend(detail::OutputBuffer& to, std::size_t least,
                                     std::size_t wanted);
    [[nodiscard]] bool is_lent_to(const detail::OutputBuffer& buffer) const
    {
        return holder_ == &buffer;
    }
    /// `from` has no output any more, or has it elsewhere.
    void give_back(detail::OutputBuffer& from, detail::Block block);

    /// An empty vector, of any capacity.
    [[nodiscard]] std::vector<std::byte> take_input();
    void give_back_input(std::vector<std::byte> input);
    /// The same, where the buffer is not much larger than `size`.
    [[nodiscard]] std::vector<std::byte> take_message(std::size_t size);
    /// `message` itself, or a copy without room if its buffer is much larger.
    [[nodiscard]] std::vector<std::byte> fitted(std::vector<std::byte> message);
    void give_back_message(std::vector<std::byte> message);

private:
    std::size_t chunk_size_;
    /// Whose output lies in the buffer; null if it is here, or nobody's.
    detail::OutputBuffer* holder_{nullptr};
    detail::Block output_;
    detail::Block last_resort_;
    std::vector<std::byte> input_;
    std::vector<std::byte> message_;
};

} // namespace busbar::channel
