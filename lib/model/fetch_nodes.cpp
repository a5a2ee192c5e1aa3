#include <algorithm>
#include <array>
#include <utility>

#include "core/fetch.hpp"
#include "tables.hpp"

namespace busbar::model::detail {

// find() reads four places of a node, and each has the address of the next: the slot, the list of
// blocks, the record, the text. A processor waits for each of them in turn; here it waits for one
// place of all nodes together.

namespace {

/// Nearly all of these are constant nodes, which are few and found in two steps.
bool is_number_of_namespace0(const NodeId& id)
{
    return id.namespace_index() == 0 && id.is_numeric();
}

} // namespace

/// Prefetches also the data beside the records, which a Browse needs.
void Tables::fetch_nodes(std::span<const NodeId* const> ids) const
{
    std::array<Sought, SpaceReader::fetched_together> all;
    const auto sought = std::span{all}.first(std::min(ids.size(), all.size()));
    fetch_nodes(ids, sought);
    for (const Sought& each : sought) {
        if (each.record != IndexTable::none) {
            busbar::detail::fetch(&links_at(each.record));
        }
    }
}

void Tables::find_nodes(std::span<const NodeId* const> ids, std::span<NodeIndex> found) const
{
    std::array<Sought, SpaceReader::fetched_together> all;
    while (!ids.empty()) {
        const auto sought = std::span{all}.first(std::min(ids.size(), all.size()));
        fetch_nodes(ids, sought);
        for (std::size_t i = 0; i < sought.size(); ++i) {
            const std::uint32_t record = std::exchange(sought[i], Sought{}).record;
            // Usually it is the prefetched one.
            const bool is_likely = record != IndexTable::none && at(record).has_id(*ids[i]);
            found[i] = is_likely ? index_of(record) : find(*ids[i]);
        }
        ids = ids.subspan(sought.size());
        found = found.subspan(sought.size());
    }
}

void Tables::fetch_nodes(std::span<const NodeHandle> handles) const
{
    for (const NodeHandle& handle : handles) {
        if (!is_constant(handle.index) && number(handle.index) - constant_count < record_count) {
            busbar::detail::fetch_object(record(handle.index));
        }
    }
}

void Tables::fetch_nodes(std::span<const NodeId* const> ids, std::span<Sought> sought) const
{
    for (std::size_t i = 0; i < sought.size(); ++i) {
        if (!is_number_of_namespace0(*ids[i])) {
            sought[i].hash = hash_value(*ids[i]);
            by_id.fetch_slot(sought[i].hash);
        }
    }
    for (std::size_t i = 0; i < sought.size(); ++i) {
        Sought& each = sought[i];
        if (!is_number_of_namespace0(*ids[i])) {
            each.record = by_id.likely(each.hash);
        }
        if (each.record != IndexTable::none) {
            busbar::detail::fetch_object(at(each.record));
        }
    }
    for (const Sought& each : sought) {
        if (each.record != IndexTable::none) {
            busbar::detail::fetch(at(each.record).text.get());
        }
    }
}

} // namespace busbar::model::detail
