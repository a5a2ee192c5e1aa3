#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include <busbar/channel/chunk_hook.hpp>

namespace busbar::harness::detail {

/// Keeps what the peers of a world have sent on secured channels as it was before, so that faults
/// and traces can read it. Remembers the last chunks only: those that are on their way to the
/// network.
class ChunkTap final : public channel::ChunkHook {
public:
    void sealing(std::span<std::byte> chunk) override;
    void sealed(std::span<std::byte> chunk) override;

    /// Returns the headers and the body of a chunk that a peer of this world has secured; nothing
    /// for others. Once for each.
    [[nodiscard]] std::vector<std::byte> take(std::span<const std::byte> chunk);

private:
    static constexpr std::size_t max_entries = 256;

    struct Entry {
        std::vector<std::byte> plain;
        /// The last bytes of the chunk as it was sent, which are of a signature or its cipher.
        std::vector<std::byte> mark;
    };
    std::vector<std::byte> plain_;
    std::deque<Entry> entries_;
};

} // namespace busbar::harness::detail
