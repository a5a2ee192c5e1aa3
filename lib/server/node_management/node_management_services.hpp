#pragma once

#include <busbar/types/node_management.hpp>

#include "node_management_needs.hpp"
#include "server/session/service.hpp"

/// The NodeManagement service set (Part 4, 5.8). All need an activated session, and answer
/// Bad_ServiceUnsupported unless ServerConfig::has_node_management is set.
namespace busbar::server::detail {

[[nodiscard]] StatusCode add_nodes(const NodeManagementNeeds& needs, ServiceContext& context,
                                   const AddNodesRequest& request, AddNodesResponse& response);
[[nodiscard]] StatusCode add_references(const NodeManagementNeeds& needs, ServiceContext& context,
                                        const AddReferencesRequest& request,
                                        AddReferencesResponse& response);
[[nodiscard]] StatusCode delete_nodes(const NodeManagementNeeds& needs, ServiceContext& context,
                                      const DeleteNodesRequest& request,
                                      DeleteNodesResponse& response);
[[nodiscard]] StatusCode delete_references(const NodeManagementNeeds& needs,
                                           ServiceContext& context,
                                           const DeleteReferencesRequest& request,
                                           DeleteReferencesResponse& response);

} // namespace busbar::server::detail
