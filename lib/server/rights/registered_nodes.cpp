#include "registered_nodes.hpp"

#include <algorithm>
#include <cstring>

namespace busbar::server::detail {

RegisteredNodes::RegisteredNodes(const model::SpaceReader& space, const Lot& lot) : space_{space}
{
    std::memcpy(&first_identifier_, lot.data(), sizeof first_identifier_);
    std::memcpy(&first_turn_, lot.data() + sizeof first_identifier_, sizeof first_turn_);
}

std::size_t RegisteredNodes::missing(std::size_t count) const
{
    return count - std::min(count, free_count_);
}

void RegisteredNodes::make_places(std::size_t count)
{
    const std::size_t before = places_.size();
    places_.resize(before + count);
    // The place with the lowest number comes first, so that a client's nodes are neighbours.
    for (std::size_t i = places_.size(); i-- > before;) {
        places_[i].node.index = model::NodeIndex{first_free_};
        first_free_ = static_cast<std::uint32_t>(i);
    }
    free_count_ += count;
}

NodeId RegisteredNodes::add(model::NodeIndex node)
{
    const std::uint32_t number = first_free_;
    Place& place = places_[number];
    first_free_ = static_cast<std::uint32_t>(place.node.index);
    --free_count_;
    place.node = space_.handle(node);
    place.is_used = true;
    const unsigned turn = (first_turn_ + place.uses) % most_uses;
    return {static_cast<std::uint16_t>(first_namespace + turn), first_identifier_ + number};
}

const RegisteredNodes::Place* RegisteredNodes::place(const NodeId& id) const
{
    if (!is_alias(id)) {
        return nullptr;
    }
    const std::uint32_t number = id.numeric() - first_identifier_; // wraps around
    if (number >= places_.size()) {
        return nullptr;
    }
    const Place& found = places_[number];
    const unsigned turn = (first_turn_ + found.uses) % most_uses;
    return found.is_used && id.namespace_index() == first_namespace + turn ? &found : nullptr;
}

void RegisteredNodes::remove(const NodeId& id)
{
    if (place(id) == nullptr) {
        return;
    }
    const std::uint32_t number = id.numeric() - first_identifier_;
    Place& freed = places_[number];
    freed.is_used = false;
    if (++freed.uses == most_uses) {
        return; // all its NodeIds were used before
    }
    freed.node.index = model::NodeIndex{first_free_};
    first_free_ = number;
    ++free_count_;
}

model::NodeIndex RegisteredNodes::find(const NodeId& alias) const
{
    const Place* const found = place(alias);
    return found != nullptr ? space_.resolve(found->node) : model::no_node;
}

std::optional<NodeId> RegisteredNodes::canonical(const NodeId& id) const
{
    const model::NodeIndex node = find(id);
    return node != model::no_node ? std::optional{space_.node_id(node)} : std::nullopt;
}

void RegisteredNodes::find_nodes(std::span<const NodeId* const> ids,
                                 std::span<model::NodeIndex> found) const
{
    std::array<model::NodeHandle, model::SpaceReader::fetched_together> handles;
    while (!ids.empty()) {
        const auto group = std::span{handles}.first(std::min(ids.size(), handles.size()));
        bool have_aliases = false;
        for (std::size_t i = 0; i < group.size(); ++i) {
            const Place* const of_alias = place(*ids[i]);
            group[i] = of_alias != nullptr ? of_alias->node : model::NodeHandle{};
            have_aliases = have_aliases || of_alias != nullptr;
        }
        if (!have_aliases) {
            space_.find_nodes(ids.first(group.size()), found);
        } else {
            space_.resolve_nodes(group, found);
            for (std::size_t i = 0; i < group.size(); ++i) {
                if (group[i].index == model::no_node) {
                    found[i] = space_.find(*ids[i]);
                }
            }
        }
        ids = ids.subspan(group.size());
        found = found.subspan(group.size());
    }
}

} // namespace busbar::server::detail
