#include <algorithm>
#include <array>

#include "fetch.hpp"
#include "tables.hpp"

namespace busbar::model::detail {

// What find() reads of a node lies in four places, and each says where the next one is: the slot,
// the list of blocks, the record, the text. A processor waits for each of them in turn; here it
// waits for one place of all nodes together.

namespace {

constexpr std::size_t line_size = 64;

/// The first place of each node, then the hash by which the others are found.
struct Sought {
    std::uint64_t hash{0};
    std::uint32_t record{IndexTable::none};
};

} // namespace

void Tables::fetch_nodes(std::span<const NodeId* const> ids) const
{
    std::array<Sought, SpaceReader::fetched_together> all;
    const auto sought = std::span{all}.first(std::min(ids.size(), all.size()));
    for (std::size_t i = 0; i < sought.size(); ++i) {
        sought[i].hash = hash_value(*ids[i]);
        by_id.fetch_slot(sought[i].hash);
    }
    for (Sought& each : sought) {
        each.record = by_id.likely(each.hash);
        if (each.record != IndexTable::none) {
            const auto* const record = reinterpret_cast<const char*>(&at(each.record));
            fetch(record);
            fetch(record + line_size);
        }
    }
    for (const Sought& each : sought) {
        if (each.record != IndexTable::none) {
            fetch(at(each.record).text.get());
        }
    }
}

} // namespace busbar::model::detail
