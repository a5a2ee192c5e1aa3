#pragma once

#include <busbar/types/node_management.hpp>

#include "node_management_context.hpp"

namespace busbar::server::detail {

/// Adds one reference in both directions (Part 4, 5.8.3): Good or a code of Table 27.
/// Bad_OutOfMemory once clients have added the maximum.
[[nodiscard]] StatusCode add_reference(NodeManagementContext& context,
                                       const AddReferencesItem& item);
/// Deletes one reference in both directions, whatever deleteBidirectional says: none has only one
/// direction (Part 4, 5.8.5). Good or a code of Table 33; Bad_NotFound if there is no such
/// reference, Bad_NoDeleteRights for one that a node was created with.
[[nodiscard]] StatusCode delete_reference(NodeManagementContext& context,
                                          const DeleteReferencesItem& item);

} // namespace busbar::server::detail
