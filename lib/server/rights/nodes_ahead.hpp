#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <busbar/model/space_reader.hpp>

#include "registered_nodes.hpp"

namespace busbar::server::detail {

/// The NodeIds in the next items of a request, as many as are looked up together. `id_of` returns
/// the NodeId of an item.
class IdsAhead {
public:
    template <typename Item, typename IdOf>
    IdsAhead(std::span<const Item> items, std::size_t next, IdOf id_of)
        : count_{std::min(model::SpaceReader::fetched_together, items.size() - next)}
    {
        for (std::size_t i = 0; i < count_; ++i) {
            ids_[i] = &id_of(items[next + i]);
        }
    }
    [[nodiscard]] std::span<const NodeId* const> span() const
    {
        return std::span{ids_}.first(count_);
    }

private:
    std::array<const NodeId*, model::SpaceReader::fetched_together> ids_;
    std::size_t count_;
};

/// The nodes that the items of a request name, looked up in groups, so that a processor waits for
/// the memory of a whole group together. Used in the order of the items, and kept for one turn at
/// most, since nodes may be added and removed between two.
class NodesAhead {
public:
    /// `registered` may be null: then no id is an alias.
    explicit NodesAhead(const model::SpaceReader& space,
                        const RegisteredNodes* registered = nullptr)
        : space_{&space}, registered_{registered}
    {
    }

    /// Returns the node of item `index`, no_node if there is none. `id_of` is as for IdsAhead.
    template <typename Item, typename IdOf>
    [[nodiscard]] model::NodeIndex find(std::span<const Item> items, std::size_t index, IdOf id_of)
    {
        if (index - first_ >= count_) { // also if it is before `first_`
            const IdsAhead ids{items, index, id_of};
            first_ = index;
            count_ = ids.span().size();
            if (registered_ != nullptr) {
                registered_->find_nodes(ids.span(), found_);
            } else if (count_ == 1) {
                found_[0] = space_->find(*ids.span()[0]);
            } else {
                space_->find_nodes(ids.span(), found_);
            }
        }
        return found_[index - first_];
    }

private:
    const model::SpaceReader* space_;
    const RegisteredNodes* registered_;
    std::size_t first_{0};
    std::size_t count_{0};
    std::array<model::NodeIndex, model::SpaceReader::fetched_together> found_;
};

/// For a service that looks its items up one by one at a deeper level: at the first item `next` of
/// a group, prefetches the nodes of the whole group.
template <typename Item, typename IdOf>
void fetch_ahead(const model::SpaceReader& space, std::span<const Item> items, std::size_t next,
                 IdOf id_of)
{
    if (next % model::SpaceReader::fetched_together == 0 && items.size() - next > 1) {
        space.fetch_nodes(IdsAhead{items, next, id_of}.span());
    }
}

} // namespace busbar::server::detail
