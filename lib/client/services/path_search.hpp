#pragma once

#include <busbar/client/resolve_nodes.hpp>

namespace busbar::client::detail {

/// True if an element of the path names no namespace, or that of OPC UA itself.
[[nodiscard]] bool may_be_searched(const BrowsePath& path);

/// Follows paths that TranslateBrowsePathsToNodeIds had no match for by browsing: a name of
/// namespace 0 stands for that of the only target that has it in any namespace. In `done`
/// Bad_NoMatch, or Bad_TooManyMatches with the names that it might be.
Operation search_paths(Requester& requester, std::vector<BrowsePath> paths,
                       std::function<void(std::vector<ResolvedNode>)> done,
                       const ServiceOptions& options);

} // namespace busbar::client::detail
