#include "view_context.hpp"

namespace busbar::server::detail {

namespace {

StatusCode check(const ViewContext& context, const Array<NodeId>& ids)
{
    if (ids.empty()) {
        return status::Bad_NothingToDo;
    }
    if (ids.size() > context.limits.operations.max_nodes_per_register_nodes) {
        return status::Bad_TooManyOperations;
    }
    // One invalid NodeId rejects the whole request (Part 4, 5.9.5.3).
    for (const NodeId& id : ids) {
        if (id.is_null()) {
            return status::Bad_NodeIdInvalid;
        }
    }
    return status::Good;
}

} // namespace

// Any NodeId is found through a hash already, so a registered one stays as it is and nothing has to
// be kept for it. Nor does the answer tell whether there is such a node.
StatusCode register_nodes(ViewContext& context, const RegisterNodesRequest& request,
                          RegisterNodesResponse& response)
{
    const StatusCode status = check(context, request.nodes_to_register);
    if (status.is_good()) {
        response.registered_node_ids = request.nodes_to_register;
    }
    return status;
}

StatusCode unregister_nodes(ViewContext& context, const UnregisterNodesRequest& request)
{
    return check(context, request.nodes_to_unregister);
}

} // namespace busbar::server::detail
