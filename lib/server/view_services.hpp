#pragma once

#include <busbar/types/view.hpp>

#include "service.hpp"

/// The View service set (Part 4, 5.9). All need an activated session.
namespace busbar::server::detail {

[[nodiscard]] StatusCode browse(ServiceContext& context, const BrowseRequest& request,
                                BrowseResponse& response);
[[nodiscard]] StatusCode browse_next(ServiceContext& context, const BrowseNextRequest& request,
                                     BrowseNextResponse& response);
[[nodiscard]] StatusCode translate_browse_paths(ServiceContext& context,
                                                const TranslateBrowsePathsToNodeIdsRequest& request,
                                                TranslateBrowsePathsToNodeIdsResponse& response);
[[nodiscard]] StatusCode register_nodes(ServiceContext& context,
                                        const RegisterNodesRequest& request,
                                        RegisterNodesResponse& response);
[[nodiscard]] StatusCode unregister_nodes(ServiceContext& context,
                                          const UnregisterNodesRequest& request,
                                          UnregisterNodesResponse& response);

} // namespace busbar::server::detail
