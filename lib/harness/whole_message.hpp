#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <busbar/harness/fault.hpp>

#include "dissector.hpp"

namespace busbar::harness::detail {

/// All chunks of one message on their way, for faults that act on it.
class WholeMessage {
public:
    explicit WholeMessage(std::vector<DissectedFrame> chunks) : chunks_{std::move(chunks)} {}

    [[nodiscard]] bool is_empty() const { return chunks_.empty(); }
    [[nodiscard]] std::span<DissectedFrame> chunks() { return chunks_; }
    /// Removes and returns the chunks.
    [[nodiscard]] std::vector<DissectedFrame> take() { return std::exchange(chunks_, {}); }

    // Each returns by how much the sequence numbers of the sender's later chunks change.

    std::uint32_t drop();
    std::uint32_t duplicate();
    /// `flaw` says why it cannot be changed, and is empty if it was.
    std::uint32_t change(const Fault::Edit& edit, std::string& flaw);
    /// Removes the chunks, which the next message overtakes.
    std::uint32_t wait(std::vector<DissectedFrame>& overtaken);
    /// Puts a message that waits after this one.
    std::uint32_t overtake(std::vector<DissectedFrame> earlier);

private:
    /// Numbers the chunks in their order, from this one on; nothing on a secured channel.
    void number_from(std::uint32_t number);

    std::vector<DissectedFrame> chunks_;
};

} // namespace busbar::harness::detail
