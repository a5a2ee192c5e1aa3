#pragma once

#include <functional>
#include <vector>

#include <busbar/client/node_address.hpp>

namespace busbar::client {

struct ResolvedNode {
    Result<NodeId> id;
    /// Where it is Bad_TooManyMatches for a name without namespace: the names that it might be, 20
    /// of them at most.
    std::vector<QualifiedName> candidates;
};

/// resolve() that also says what a path might have meant.
Operation resolve_nodes(Requester& requester, std::vector<NodeAddress> addresses,
                        std::function<void(std::vector<ResolvedNode>)> done,
                        const ServiceOptions& options = {});

} // namespace busbar::client
