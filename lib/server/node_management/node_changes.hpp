#pragma once

#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/node_management.hpp>

#include "node_management_context.hpp"

namespace busbar::server::detail {

/// Adds one node (Part 4, 5.8.2) and, below an Object or Variable, the Mandatory members of its
/// type; returns its NodeId, or a code of Table 24. Bad_OutOfMemory once clients have added the
/// maximum. After an error nothing was added.
[[nodiscard]] Result<NodeId> add_node(NodeManagementContext& context, const AddNodesItem& item);

/// Adds one reference in both directions (Part 4, 5.8.3): Good or a code of Table 27.
/// Bad_OutOfMemory once clients have added the maximum.
[[nodiscard]] StatusCode add_reference(NodeManagementContext& context,
                                       const AddReferencesItem& item);
/// Deletes one reference in both directions, whatever deleteBidirectional says: none has only one
/// direction (Part 4, 5.8.5). Good or a code of Table 33; Bad_NotFound if there is no such
/// reference, Bad_NoDeleteRights for one that a node was created with.
[[nodiscard]] StatusCode delete_reference(NodeManagementContext& context,
                                          const DeleteReferencesItem& item);

/// One end of a reference, existing or about to be added.
struct ReferenceEnd {
    NodeClass node_class{NodeClass::Unspecified};
    /// The type definition of an Object or Variable.
    model::NodeIndex type_definition{model::no_node};
};

[[nodiscard]] ReferenceEnd reference_end(const model::AddressSpace& space, model::NodeIndex node);

/// Returns Good, or Bad_ReferenceNotAllowed if a reference of `type` never connects such nodes
/// (Part 3, clause 7). Does not repeat the checks of AddressSpace.
[[nodiscard]] StatusCode check_ends(const model::AddressSpace& space, model::NodeIndex type,
                                    const ReferenceEnd& source, const ReferenceEnd& target);

} // namespace busbar::server::detail
