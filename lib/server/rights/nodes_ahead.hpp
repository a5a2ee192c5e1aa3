#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <busbar/model/space_reader.hpp>

namespace busbar::server::detail {

/// Before item `next` of a request is looked at: where it begins another group of items, has the
/// nodes of all of the group fetched. `id_of` is the NodeId that an item names.
template <typename Item, typename IdOf>
void fetch_ahead(const model::SpaceReader& space, std::span<const Item> items, std::size_t next,
                 IdOf id_of)
{
    constexpr std::size_t together = model::SpaceReader::fetched_together;
    const std::size_t count = std::min(together, items.size() - next);
    if (next % together != 0 || count == 1) {
        return;
    }
    std::array<const NodeId*, together> ids;
    for (std::size_t i = 0; i < count; ++i) {
        ids[i] = &id_of(items[next + i]);
    }
    space.fetch_nodes(std::span{ids}.first(count));
}

} // namespace busbar::server::detail
