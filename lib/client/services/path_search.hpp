#pragma once

#include <functional>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/client/requester.hpp>
#include <busbar/types/view.hpp>

namespace busbar::client::detail {

/// Maximum number of candidates that are reported.
constexpr std::size_t max_candidates = 20;

struct SearchedPath {
    Result<NodeId> id;
    /// As in ResolvedNode; a path without elements is its starting node.
    std::vector<BrowsePath> candidates;
};

/// True if an element of the path has no namespace, or that of OPC UA itself.
[[nodiscard]] bool may_be_searched(const BrowsePath& path);

/// Follows paths by browsing for which TranslateBrowsePathsToNodeIds had no match: a name in
/// namespace 0 stands for the only target with this name in any namespace. `done` gets Bad_NoMatch,
/// or Bad_TooManyMatches with the candidates.
Operation search_paths(Requester& requester, std::vector<BrowsePath> paths,
                       std::function<void(std::vector<SearchedPath>)> done,
                       const ServiceOptions& options);

} // namespace busbar::client::detail
