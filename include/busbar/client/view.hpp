#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/view.hpp>

namespace busbar::client {

/// Limits of what is taken from a server that has more, or never ends.
struct BrowseLimits {
    /// References of one node, and of all nodes of one operation.
    std::size_t max_references_per_node{100'000};
    std::size_t max_references{1'000'000};
    /// Maximum number of successive answers without a reference by which a server says that there
    /// are more.
    std::uint32_t max_empty_answers{10};
    /// RequestedMaxReferencesPerNode (Part 4, 5.9.2); 0: the server chooses.
    std::uint32_t references_per_answer{0};
};

/// Browses nodes (Part 4, 5.9.2) and continues with BrowseNext until there are no more references.
/// `done` gets a result for each node, without continuation points. If a limit or a failure ended
/// it, the status is Uncertain_NotAllNodesAvailable and the result has the references so far.
///
/// If the server has too few continuation points, nodes wait for others. Unused continuation points
/// are released, also after cancel().
BUSBAR_API Operation browse(Requester& requester, std::vector<BrowseDescription> nodes,
                            std::function<void(std::vector<BrowseResult>)> done,
                            BrowseLimits limits = {}, const ServiceOptions& options = {});

/// Returns the argument of browse() for the forward hierarchical references of a node, with all
/// information about their targets.
[[nodiscard]] BUSBAR_API BrowseDescription children_of(NodeId node);

/// The limits of browsing a tree.
struct TreeLimits {
    /// Levels below the roots.
    std::size_t max_depth{100};
    std::size_t max_nodes{100'000};
    BrowseLimits browse;
};

/// A node of a tree, with the way that led to it.
struct TreeNode {
    static constexpr std::size_t no_parent = SIZE_MAX;
    /// The index of the node at which it was found first; no_parent for a root.
    std::size_t parent{no_parent};
    std::size_t depth{0};
    /// The reference by which it was found; for a root only the node_id.
    ReferenceDescription reference;
    /// The result of browsing it; Good if it was not browsed because it is a node of another
    /// server.
    StatusCode status;
};

/// The result of browsing a tree.
struct BrowsedTree {
    /// Parents before their children; each node once, by HasEventSource or HasNotifier only last.
    std::vector<TreeNode> nodes;
    /// False if a limit or a failure left something out.
    bool is_complete{true};
};

/// Browses from `roots` downwards, along the references that `how` names; its node_id is not used.
/// Nodes of other servers are listed, not browsed.
BUSBAR_API Operation browse_tree(Requester& requester, std::vector<NodeId> roots,
                                 const BrowseDescription& how,
                                 std::function<void(BrowsedTree)> done, TreeLimits limits = {},
                                 const ServiceOptions& options = {});

/// TranslateBrowsePathsToNodeIds (Part 4, 5.9.4). For NodeAddresses, see resolve().
BUSBAR_API Operation translate(Requester& requester, std::vector<BrowsePath> paths,
                               std::function<void(std::vector<BrowsePathResult>)> done,
                               const ServiceOptions& options = {});

/// RegisterNodes (Part 4, 5.9.5). The ids are valid for the session only.
BUSBAR_API Operation register_nodes(Requester& requester, std::vector<NodeId> nodes,
                                    std::function<void(std::vector<Result<NodeId>>)> done,
                                    const ServiceOptions& options = {});

/// UnregisterNodes (Part 4, 5.9.6). Unknown ids are not an error.
BUSBAR_API Operation unregister_nodes(Requester& requester, std::vector<NodeId> nodes,
                                      std::function<void(std::vector<StatusCode>)> done,
                                      const ServiceOptions& options = {});

} // namespace busbar::client
