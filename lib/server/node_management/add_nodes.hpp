#pragma once

#include <busbar/types/node_management.hpp>

#include "node_management_context.hpp"

namespace busbar::server::detail {

/// Adds one node (Part 4, 5.8.2) and, below an Object or Variable, the Mandatory members of its
/// type; returns its NodeId, or a code of Table 24. Bad_OutOfMemory once clients have added the
/// maximum. An error leaves nothing behind.
[[nodiscard]] Result<NodeId> add_node(NodeManagementContext& context, const AddNodesItem& item);

} // namespace busbar::server::detail
