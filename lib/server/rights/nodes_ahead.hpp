#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <busbar/model/space_reader.hpp>

namespace busbar::server::detail {

/// The nodes that the items of a request name, looked up in groups: a processor then waits for the
/// memory of all of a group together. Asked in the order of the items, and kept for no longer than
/// one turn: nodes may come and go between two.
class NodesAhead {
public:
    explicit NodesAhead(const model::SpaceReader& space) : space_{&space} {}

    /// The node of item `index`, no_node if there is none. `id_of` is the NodeId that an item
    /// names.
    template <typename Item, typename IdOf>
    [[nodiscard]] model::NodeIndex find(std::span<const Item> items, std::size_t index, IdOf id_of)
    {
        if (index - first_ >= count_) { // also if it is before `first_`
            look_up(items, index, id_of);
        }
        return found_[index - first_];
    }

private:
    static constexpr std::size_t together = model::SpaceReader::fetched_together;

    template <typename Item, typename IdOf>
    void look_up(std::span<const Item> items, std::size_t index, IdOf id_of)
    {
        first_ = index;
        count_ = std::min(together, items.size() - index);
        if (count_ == 1) {
            found_[0] = space_->find(id_of(items[index]));
            return;
        }
        std::array<const NodeId*, together> ids;
        for (std::size_t i = 0; i < count_; ++i) {
            ids[i] = &id_of(items[index + i]);
        }
        space_->find_nodes(std::span{ids}.first(count_), found_);
    }

    const model::SpaceReader* space_;
    std::size_t first_{0};
    std::size_t count_{0};
    std::array<model::NodeIndex, together> found_;
};

/// For a service whose items are looked up one by one and deeper down: where item `next` begins
/// another group of items, has the nodes of all of the group fetched.
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
