#include "client_nodes.hpp"

namespace busbar::server::detail {

namespace {

bool is_gone(const model::AddressSpace& space, model::NodeIndex index, std::uint32_t generation)
{
    return space.resolve({index, generation}) == model::no_node;
}

} // namespace

void ClientNodes::refresh(const model::AddressSpace& space)
{
    if (refreshed_at_ == space.change_count()) {
        return;
    }
    refreshed_at_ = space.change_count();
    for (auto at = nodes_.begin(); at != nodes_.end();) {
        const bool goes = is_gone(space, at->first, at->second.generation);
        bytes_ -= goes ? at->second.bytes : 0;
        at = goes ? nodes_.erase(at) : std::next(at);
    }
    for (auto at = references_.begin(); at != references_.end();) {
        const auto& [source, of_source, target, of_target, type] = *at;
        const bool goes = is_gone(space, source, of_source) || is_gone(space, target, of_target);
        at = goes ? references_.erase(at) : std::next(at);
    }
}

void ClientNodes::add(model::NodeHandle node, std::size_t bytes)
{
    Node& entry = nodes_[node.index];
    bytes_ += bytes - entry.bytes; // in place of one that is gone
    entry = {node.generation, bytes};
}

} // namespace busbar::server::detail
