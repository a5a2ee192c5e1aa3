#pragma once

#include <functional>
#include <vector>

#include <busbar/client/node_address.hpp>

namespace busbar::client {

/// The result for one address.
struct ResolvedNode {
    Result<NodeId> id;
    /// For Bad_TooManyMatches, at most 20 addresses that the path may mean. A path whose names have
    /// their namespaces up to the one that fits several nodes; for nodes that share even the
    /// namespace a path from the node, or its NodeId.
    std::vector<NodeAddress> candidates;
};

/// Resolves as resolve() does, and lists the candidates of ambiguous paths.
BUSBAR_API Operation resolve_nodes(Requester& requester, std::vector<NodeAddress> addresses,
                                   std::function<void(std::vector<ResolvedNode>)> done,
                                   const ServiceOptions& options = {});

} // namespace busbar::client
