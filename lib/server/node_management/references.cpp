#include "node_changes.hpp"

#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

#include "server/rights/hierarchy.hpp"

namespace busbar::server::detail {

namespace {

using model::NodeIndex;

/// A reference in its forward direction.
struct Ends {
    NodeIndex source;
    NodeIndex type;
    NodeIndex target;
};

Ends ends(NodeIndex from, NodeIndex type, NodeIndex to, bool is_forward)
{
    return is_forward ? Ends{from, type, to} : Ends{to, type, from};
}

/// Returns Good if the item's target is a node of this server. All references are local.
StatusCode check_server(const NodeManagementContext& context, const AddReferencesItem& item)
{
    const std::string_view uri = item.target_server_uri.view();
    const bool is_here = uri.empty() || uri == context.application_uri;
    if (!is_here && uri.find(':') == std::string_view::npos) {
        return status::Bad_ServerUriInvalid;
    }
    return is_here && item.target_node_id.server_index == 0 ? status::Good
                                                            : status::Bad_ReferenceLocalOnly;
}

/// The user must have the right at both ends.
StatusCode check_rights(const NodeManagementContext& context, const Ends& reference,
                        StatusCode (NodeRights::*right)(NodeIndex) const)
{
    const StatusCode refusal = (context.rights.*right)(reference.source);
    return refusal.is_bad() ? refusal : (context.rights.*right)(reference.target);
}

/// Returns Good if the model allows the reference.
StatusCode check_model(NodeManagementContext& context, const Ends& reference)
{
    const model::AddressSpace& space = context.space;
    const auto& [source, type, target] = reference;
    if (source == target && space.is_subtype_of(type, id::HierarchicalReferences)) {
        return status::Bad_InvalidSelfReference;
    }
    // HasChild never forms a circle (Part 3, 7.5).
    const bool goes_round =
        space.is_subtype_of(type, id::HasChild) &&
        (is_below(space, source, target, space.find(id::HasChild), context.visits_left) ||
         context.visits_left == 0);
    return goes_round ? status::Bad_ReferenceNotAllowed
                      : check_ends(space, type, reference_end(space, source),
                                   reference_end(space, target));
}

bool is_there(const model::AddressSpace& space, const Ends& reference)
{
    model::ReferenceCursor cursor = space.references(reference.source);
    while (const auto each = cursor.next()) {
        if (each->is_forward && each->type == reference.type && each->target == reference.target) {
            return true;
        }
    }
    return false;
}

/// Returns the ends of the reference in an item, or why there are none.
template <typename Item>
Result<Ends> find_ends(const NodeManagementContext& context, const Item& item,
                       StatusCode server_status)
{
    const NodeIndex source = context.find(item.source_node_id);
    if (source == model::no_node) {
        return fail(status::Bad_SourceNodeIdInvalid);
    }
    const NodeIndex type = context.find_reference_type(item.reference_type_id);
    if (type == model::no_node) {
        return fail(status::Bad_ReferenceTypeIdInvalid);
    }
    if (server_status.is_bad()) {
        return fail(server_status);
    }
    const NodeIndex target = context.find(item.target_node_id);
    if (target == model::no_node) {
        return fail(status::Bad_TargetNodeIdInvalid);
    }
    return ends(source, type, target, item.is_forward);
}

} // namespace

StatusCode add_reference(NodeManagementContext& context, const AddReferencesItem& item)
{
    const auto found = find_ends(context, item, check_server(context, item));
    if (!found) {
        return found.error();
    }
    model::AddressSpace& space = context.space;
    if (space.node_class(context.find(item.target_node_id)) != item.target_node_class) {
        return status::Bad_NodeClassInvalid;
    }
    const StatusCode refusal = check_rights(context, *found, &NodeRights::check_add_reference);
    if (refusal.is_bad()) {
        return refusal;
    }
    if (const StatusCode bad = check_model(context, *found); bad.is_bad()) {
        return bad;
    }
    if (!context.client_nodes.has_room_for_reference(context.limits)) {
        return status::Bad_OutOfMemory;
    }
    const model::NodeIndex source = found->source;
    const model::NodeIndex target = found->target;
    const auto added = space.add_reference(source, item.reference_type_id, target);
    if (!added) {
        return added.error();
    }
    busbar::detail::Undo undo{
        [&] { static_cast<void>(space.remove_reference(source, item.reference_type_id, target)); }};
    context.client_nodes.add_reference(space, source, found->type, target);
    undo.keep();
    return status::Good;
}

StatusCode delete_reference(NodeManagementContext& context, const DeleteReferencesItem& item)
{
    const bool is_here = item.target_node_id.server_index == 0;
    const auto found =
        find_ends(context, item, is_here ? status::Good : status::Bad_ServerIndexInvalid);
    if (!found) {
        return found.error();
    }
    const StatusCode refusal = check_rights(context, *found, &NodeRights::check_remove_reference);
    if (refusal.is_bad()) {
        return refusal;
    }
    const auto& [source, type, target] = *found;
    if (!context.space.remove_reference(source, item.reference_type_id, target)) {
        return is_there(context.space, *found) ? status::Bad_NoDeleteRights : status::Bad_NotFound;
    }
    context.client_nodes.remove_reference(source, type, target);
    return status::Good;
}

} // namespace busbar::server::detail
