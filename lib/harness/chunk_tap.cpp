#include "chunks.hpp"

#include <algorithm>
#include <utility>

namespace busbar::harness::detail {

namespace {

/// Two chunks with the same last bytes are copies of each other.
constexpr std::size_t mark_size = 32;

std::span<const std::byte> mark_of(std::span<const std::byte> chunk)
{
    return chunk.last(std::min(chunk.size(), mark_size));
}

} // namespace

void ChunkTap::sealing(std::span<std::byte> chunk)
{
    plain_.assign(chunk.begin(), chunk.end());
}

void ChunkTap::sealed(std::span<std::byte> chunk)
{
    if (std::equal(chunk.begin(), chunk.end(), plain_.begin(), plain_.end())) {
        return; // the channel has no security
    }
    if (entries_.size() == max_entries) {
        entries_.pop_front();
    }
    const auto mark = mark_of(chunk);
    entries_.push_back({std::exchange(plain_, {}), {mark.begin(), mark.end()}});
}

std::vector<std::byte> ChunkTap::take(std::span<const std::byte> chunk)
{
    const auto mark = mark_of(chunk);
    const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
        return std::equal(mark.begin(), mark.end(), entry.mark.begin(), entry.mark.end());
    });
    if (found == entries_.end()) {
        return {};
    }
    auto plain = std::move(found->plain);
    entries_.erase(found);
    return plain;
}

} // namespace busbar::harness::detail
