#pragma once

#include <busbar/types/node_management.hpp>

#include "node_management_needs.hpp"
#include "server/session/service.hpp"

/// The NodeManagement service set (Part 4, 5.8). All need an activated session, and answer
/// Bad_ServiceUnsupported unless ServerConfig::has_node_management is set.
namespace busbar::server::detail {

[[nodiscard]] std::unique_ptr<ServiceOperation> make_add_nodes(const NodeManagementNeeds& needs);
[[nodiscard]] std::unique_ptr<ServiceOperation>
make_add_references(const NodeManagementNeeds& needs);
[[nodiscard]] std::unique_ptr<ServiceOperation> make_delete_nodes(const NodeManagementNeeds& needs);
[[nodiscard]] std::unique_ptr<ServiceOperation>
make_delete_references(const NodeManagementNeeds& needs);

} // namespace busbar::server::detail
