#pragma once

#include <functional>
#include <vector>

#include <busbar/client/node_address.hpp>

namespace busbar::client {

struct ResolvedNode {
    Result<NodeId> id;
    /// Where it is Bad_TooManyMatches: what the path might mean, 20 of them at most. A path whose
    /// names have their namespaces up to the one that fits several nodes; for nodes that have even
    /// the namespace in common a path from the node, or its NodeId.
    std::vector<NodeAddress> candidates;
};

/// resolve() that also says what a path might have meant.
BUSBAR_API Operation resolve_nodes(Requester& requester, std::vector<NodeAddress> addresses,
                                   std::function<void(std::vector<ResolvedNode>)> done,
                                   const ServiceOptions& options = {});

} // namespace busbar::client
