#include "watch_table.hpp"

#include <vector>

#include "tables.hpp"

namespace busbar::model {

namespace detail {

WatchTable::~WatchTable()
{
    for (auto& [key, first] : watches_) {
        while (first != nullptr) {
            take_out(*first);
        }
    }
}

void WatchTable::put_in_front(NodeWatch*& first, NodeWatch& watch)
{
    watch.next_ = first;
    watch.link_ = &first;
    if (first != nullptr) {
        first->link_ = &watch.next_;
    }
    first = &watch;
}

void WatchTable::take_out(NodeWatch& watch)
{
    *watch.link_ = watch.next_;
    if (watch.next_ != nullptr) {
        watch.next_->link_ = watch.link_;
    }
    watch.link_ = nullptr;
    watch.next_ = nullptr;
    watch.table_ = nullptr;
}

void WatchTable::add(NodeIndex node, NodeAspect aspect, NodeWatch& watch)
{
    watch.stop();
    put_in_front(watches_[key(node, aspect)], watch);
    watch.table_ = this;
    watch.node_ = node;
    watch.aspect_ = aspect;
}

void WatchTable::remove(NodeWatch& watch)
{
    const bool may_be_last = watch.next_ == nullptr;
    take_out(watch);
    if (may_be_last) {
        const auto found = watches_.find(key(watch.node_, watch.aspect_));
        if (found != watches_.end() && found->second == nullptr) {
            watches_.erase(found);
        }
    }
}

/// The watches to be notified leave the table first: a notified watch may remove any of them, and
/// watches that it adds are not notified.
void WatchTable::tell(std::uint64_t key, bool is_removed)
{
    const auto found = watches_.find(key);
    if (found == watches_.end()) {
        return;
    }
    NodeWatch* first = found->second;
    first->link_ = &first;
    watches_.erase(found);
    while (first != nullptr) {
        NodeWatch& watch = *first;
        take_out(watch);
        watch.node_changed(watch.node_, is_removed);
    }
}

void WatchTable::tell_removed(NodeIndex node)
{
    for (const NodeAspect aspect : {NodeAspect::Existence, NodeAspect::Binding,
                                    NodeAspect::References, NodeAspect::ReferencePositions}) {
        if (!watches_.empty()) {
            tell(key(node, aspect), true);
        }
    }
}

void WatchTable::tell_bindings(FunctionRef<bool(NodeIndex)> is_meant)
{
    std::vector<NodeIndex> nodes;
    for (const auto& [key, first] : watches_) {
        if (first->aspect_ == NodeAspect::Binding && is_meant(first->node_)) {
            nodes.push_back(first->node_);
        }
    }
    for (const NodeIndex node : nodes) {
        tell(node, NodeAspect::Binding);
    }
}

} // namespace detail

void NodeWatch::stop()
{
    if (table_ != nullptr) {
        table_->remove(*this);
    }
}

void SpaceJournal::watch(NodeIndex node, NodeAspect aspect, NodeWatch& watch) const
{
    space_->tables_->watches.add(node, aspect, watch);
}

} // namespace busbar::model
