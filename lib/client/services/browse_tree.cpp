#include <set>

#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "handlers.hpp"

namespace busbar::client {

namespace {

/// References that say where events are from (Part 3, 7.17 and 7.18), not where a node belongs.
bool is_of_events(const ReferenceDescription& reference)
{
    return reference.reference_type_id == NodeId{0, id::HasEventSource} ||
           reference.reference_type_id == NodeId{0, id::HasNotifier};
}

/// Browses level by level; a node that was already found is not browsed again.
class TreeOperation final : public detail::OperationState,
                            public std::enable_shared_from_this<TreeOperation> {
public:
    using Done = std::function<void(BrowsedTree)>;

    TreeOperation(Requester& requester, BrowseDescription how, Done done, TreeLimits limits,
                  const ServiceOptions& options)
        : requester_{requester}, how_{std::move(how)}, done_{std::move(done)}, limits_{limits},
          options_{options}
    {
    }

    void begin(std::vector<NodeId> roots)
    {
        for (NodeId& root : roots) {
            ReferenceDescription reference;
            reference.node_id = std::move(root);
            add(TreeNode::no_parent, 0, std::move(reference));
        }
        if (!browse_level()) {
            later_ = detail::later(requester_, [self = shared_from_this()] { self->finish(); });
            is_later_ = true;
        }
    }
    void cancel() override
    {
        done_ = nullptr;
        step_.cancel();
        if (is_later_) {
            requester_.cancel(later_);
        }
    }
    /// Nodes that were not browsed completely have failed.
    void no_memory()
    {
        if (done_ == nullptr) {
            return;
        }
        tree_.is_complete = false;
        for (const auto* const nodes : {&level_, &next_}) {
            for (const std::size_t node : *nodes) {
                tree_.nodes[node].status = status::Bad_OutOfMemory;
            }
        }
        finish();
    }

private:
    void add(std::size_t parent, std::size_t depth, ReferenceDescription reference)
    {
        if (seen_.contains(reference.node_id)) {
            return;
        }
        if (tree_.nodes.size() >= limits_.max_nodes) {
            tree_.is_complete = false;
            return;
        }
        seen_.insert(reference.node_id);
        const bool is_local = reference.node_id.is_local();
        tree_.nodes.push_back({parent, depth, std::move(reference), {}});
        if (is_local) {
            next_.push_back(tree_.nodes.size() - 1);
        }
    }
    /// Adds the nodes that only a reference of events led to; false if there are none.
    bool add_sources_of_events()
    {
        const std::size_t before = tree_.nodes.size();
        for (auto& [parent, reference] : std::exchange(sources_, {})) {
            add(parent, tree_.nodes[parent].depth + 1, std::move(reference));
        }
        return tree_.nodes.size() != before;
    }
    /// Returns false if there is nothing to browse.
    bool browse_level()
    {
        level_.clear();
        do {
            for (const std::size_t node : std::exchange(next_, {})) {
                const bool is_browsed = tree_.nodes[node].depth < limits_.max_depth;
                tree_.is_complete = tree_.is_complete && is_browsed; // the nodes below are unknown
                if (is_browsed) {
                    level_.push_back(node);
                }
            }
        } while (level_.empty() && add_sources_of_events());
        if (level_.empty()) {
            return false;
        }
        std::vector<BrowseDescription> items;
        for (const std::size_t node : level_) {
            items.push_back(how_);
            items.back().node_id = tree_.nodes[node].reference.node_id.node_id;
        }
        step_ = browse(requester_, std::move(items),
                       detail::step_of(shared_from_this(),
                                       [](TreeOperation& self, std::vector<BrowseResult> results) {
                                           self.browsed(std::move(results));
                                       }),
                       limits_.browse, options_);
        return true;
    }
    void browsed(std::vector<BrowseResult> results)
    {
        for (std::size_t i = 0; i < level_.size(); ++i) {
            const std::size_t parent = level_[i];
            tree_.nodes[parent].status = results[i].status_code;
            tree_.is_complete = tree_.is_complete && results[i].status_code.is_good();
            const std::size_t depth = tree_.nodes[parent].depth + 1;
            for (ReferenceDescription& reference : results[i].references) {
                if (is_of_events(reference)) {
                    sources_.emplace_back(parent, std::move(reference));
                } else {
                    add(parent, depth, std::move(reference));
                }
            }
        }
        if (!browse_level()) {
            finish();
        }
    }
    void finish()
    {
        if (const Done done = std::exchange(done_, nullptr)) {
            done(std::move(tree_));
        }
    }

    Requester& requester_;
    BrowseDescription how_;
    Done done_;
    TreeLimits limits_;
    ServiceOptions options_;
    BrowsedTree tree_;
    std::set<ExpandedNodeId> seen_;
    std::vector<std::size_t> level_; // indices of nodes that are browsed now
    std::vector<std::size_t> next_;  // indices of nodes that are browsed next
    /// Nodes that events come from, with the node at which they were found: they stand below it
    /// only if no other reference leads to them.
    std::vector<std::pair<std::size_t, ReferenceDescription>> sources_;
    Operation step_;
    RequestId later_{0};
    bool is_later_{false};
};

} // namespace

Operation browse_tree(Requester& requester, std::vector<NodeId> roots, const BrowseDescription& how,
                      std::function<void(BrowsedTree)> done, TreeLimits limits,
                      const ServiceOptions& options)
{
    const auto operation =
        std::make_shared<TreeOperation>(requester, how, std::move(done), limits, options);
    operation->begin(std::move(roots));
    return Operation{operation};
}

} // namespace busbar::client
