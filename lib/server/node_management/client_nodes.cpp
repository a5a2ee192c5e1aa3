#include "client_nodes.hpp"

#include <busbar/core/detail/guarded.hpp>

namespace busbar::server::detail {

using model::NodeAspect;
using model::NodeIndex;

void ClientNodes::Node::node_changed(NodeIndex node, bool /*is_removed*/)
{
    owner.bytes_ -= bytes;
    owner.nodes_.erase(node); // and this with it
}

void ClientNodes::End::node_changed(NodeIndex /*node*/, bool /*is_removed*/)
{
    const ReferenceKey of = key; // as this goes
    owner.references_.erase(of);
}

void ClientNodes::add(const model::AddressSpace& space, NodeIndex node, std::size_t bytes)
{
    const auto [entry, is_new] = nodes_.try_emplace(node, *this);
    busbar::detail::Undo undo{[this, at = entry] { nodes_.erase(at); }};
    space.journal().watch(node, NodeAspect::Existence, entry->second);
    undo.keep();
    bytes_ += bytes - entry->second.bytes;
    entry->second.bytes = bytes;
}

void ClientNodes::add_reference(const model::AddressSpace& space, NodeIndex source, NodeIndex type,
                                NodeIndex target)
{
    const ReferenceKey key{source, type, target};
    const auto entry = references_.try_emplace(key, *this, key).first;
    Ends& ends = entry->second;
    busbar::detail::Undo undo{[&] { references_.erase(entry); }};
    space.journal().watch(source, NodeAspect::Existence, ends.source);
    space.journal().watch(target, NodeAspect::Existence, ends.target);
    undo.keep();
}

} // namespace busbar::server::detail
