#include "node_management_services.hpp"

#include "add_nodes.hpp"
#include "references.hpp"
#include "server/session/session_rights.hpp"

namespace busbar::server::detail {

namespace {

NodeManagementContext management_context(const NodeManagementNeeds& needs, const Session& session)
{
    return {needs.space,         rights_of(session, needs.space, needs.access),
            needs.config.limits, needs.client_nodes,
            needs.own_namespace, needs.config.application_uri};
}

AddNodesResult add_one(NodeManagementContext& context, const AddNodesItem& item)
{
    auto added = add_node(context, item);
    return added ? AddNodesResult{status::Good, *std::move(added)}
                 : AddNodesResult{added.error(), {}};
}

/// Deletes the node with all that was added below it, and all references to these, whatever
/// deleteTargetReferences says: a server may delete more than it was asked to (Part 4, 5.8.4.1),
/// and here no reference leads nowhere. So there is no Uncertain_ReferenceNotDeleted.
StatusCode delete_one(NodeManagementContext& context, const DeleteNodesItem& item)
{
    const model::NodeIndex node = context.find(item.node_id);
    if (node == model::no_node) {
        return why_not_found(item.node_id);
    }
    StatusCode refusal = status::Good;
    context.space.for_each_below(node, [&](model::NodeIndex each) {
        refusal = context.rights.check_delete_node(each);
        return refusal.is_good();
    });
    if (refusal.is_bad()) {
        return refusal;
    }
    const auto removed = context.space.remove(node);
    return removed ? status::Good : removed.error();
}

/// Carries out all of a request's items by `one` and tells clients of what has changed.
template <typename Items, typename Results>
StatusCode for_each_item(const NodeManagementNeeds& needs, ServiceContext& context,
                         const Items& items, Results& results,
                         typename Results::value_type (*one)(NodeManagementContext&,
                                                             const typename Items::value_type&))
{
    if (!needs.config.has_node_management) {
        return status::Bad_ServiceUnsupported;
    }
    if (items.empty()) {
        return status::Bad_NothingToDo;
    }
    if (items.size() > needs.config.limits.operations.max_nodes_per_node_management) {
        return status::Bad_TooManyOperations;
    }
    NodeManagementContext management = management_context(needs, *context.session);
    results.reserve(items.size());
    for (const auto& item : items) {
        results.push_back(one(management, item));
    }
    needs.observer.model_changed();
    return status::Good;
}

} // namespace

StatusCode add_nodes(const NodeManagementNeeds& needs, ServiceContext& context,
                     const AddNodesRequest& request, AddNodesResponse& response)
{
    return for_each_item(needs, context, request.nodes_to_add, response.results, add_one);
}

StatusCode add_references(const NodeManagementNeeds& needs, ServiceContext& context,
                          const AddReferencesRequest& request, AddReferencesResponse& response)
{
    return for_each_item(needs, context, request.references_to_add, response.results,
                         add_reference);
}

StatusCode delete_nodes(const NodeManagementNeeds& needs, ServiceContext& context,
                        const DeleteNodesRequest& request, DeleteNodesResponse& response)
{
    return for_each_item(needs, context, request.nodes_to_delete, response.results, delete_one);
}

StatusCode delete_references(const NodeManagementNeeds& needs, ServiceContext& context,
                             const DeleteReferencesRequest& request,
                             DeleteReferencesResponse& response)
{
    return for_each_item(needs, context, request.references_to_delete, response.results,
                         delete_reference);
}

} // namespace busbar::server::detail
