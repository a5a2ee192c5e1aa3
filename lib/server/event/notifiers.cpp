#include "notifiers.hpp"

#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

using model::no_node;
using model::NodeIndex;

const std::vector<NodeIndex>& Notifiers::above(NodeIndex source)
{
    if (seen_.size() > 2 * max_notifiers_) { // most are from earlier rounds, or removed
        seen_.clear();
    }
    ++round_;
    found_.clear();
    // All events reach the Server object, whatever their source is (Part 3, 7.18; Part 5, 8.3.2).
    add(space_->find(id::Server));
    add(source);
    for (std::size_t i = 1; i < found_.size() && found_.size() < max_notifiers_; ++i) {
        for (const NodeIndex notifier : directly_above(found_[i])) {
            add(notifier);
        }
    }
    return found_;
}

void Notifiers::add(NodeIndex node)
{
    if (node != no_node && found_.size() < max_notifiers_ &&
        std::exchange(seen_[node], round_) != round_) {
        found_.push_back(node);
    }
}

const std::vector<NodeIndex>& Notifiers::directly_above(NodeIndex node)
{
    const auto [entry, is_new] = directly_above_.try_emplace(node, *this);
    std::vector<NodeIndex>& above = entry->second.nodes;
    if (is_new) {
        space_->journal().watch(node, model::NodeAspect::References, entry->second);
        // HasNotifier is a subtype of it.
        const NodeIndex has_event_source = space_->find(id::HasEventSource);
        model::ReferenceCursor references = space_->references(node);
        while (const auto reference = references.next()) {
            if (!reference->is_forward &&
                space_->is_subtype_of(reference->type, has_event_source)) {
                above.push_back(reference->target);
            }
        }
    }
    return above;
}

} // namespace busbar::server::detail
