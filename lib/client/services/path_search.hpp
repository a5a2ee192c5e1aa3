#pragma once

#include <functional>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/client/requester.hpp>
#include <busbar/types/view.hpp>

namespace busbar::client::detail {

/// What a path might mean is told up to this number.
constexpr std::size_t max_candidates = 20;

struct SearchedPath {
    Result<NodeId> id;
    /// As those of ResolvedNode; a path without elements is its starting node.
    std::vector<BrowsePath> candidates;
};

/// True if an element of the path names no namespace, or that of OPC UA itself.
[[nodiscard]] bool may_be_searched(const BrowsePath& path);

/// Follows paths that TranslateBrowsePathsToNodeIds had no match for by browsing: a name of
/// namespace 0 stands for that of the only target that has it in any namespace. In `done`
/// Bad_NoMatch, or Bad_TooManyMatches with what the path might mean.
Operation search_paths(Requester& requester, std::vector<BrowsePath> paths,
                       std::function<void(std::vector<SearchedPath>)> done,
                       const ServiceOptions& options);

} // namespace busbar::client::detail
