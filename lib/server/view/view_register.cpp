#include <memory>

#include <busbar/core/detail/guarded.hpp>

#include "server/rights/live_values.hpp"
#include "server/rights/nodes_ahead.hpp"
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

/// Returns whether an alias makes it faster to find: a Variable that is looked up by its hash and
/// has its value with its node.
bool deserves_alias(const ViewContext& context, model::NodeIndex node)
{
    // A space with so many namespaces needs the indices of aliases itself.
    return context.space.namespace_count() <= RegisteredNodes::first_namespace &&
           node != model::no_node && !context.space.is_constant(node) &&
           context.space.node_class(node) == NodeClass::Variable &&
           context.space.node_id(node).namespace_index() != 0 &&
           context.space.variable(node).source != live_values_source && context.may_see(node);
}

/// Returns an object with a free place for one more alias if the session can pay for it, else null.
RegisteredNodes* place_for_one(ViewContext& context)
{
    auto& registered = context.session.registered;
    const bool is_first = registered == nullptr;
    const std::size_t missing = is_first ? 1 : registered->missing(1);
    const std::size_t cost =
        missing * RegisteredNodes::place_memory + (is_first ? sizeof(RegisteredNodes) : 0);
    RegisteredNodes::Lot lot;
    if (!context.session.charge(cost)) {
        return nullptr;
    }
    busbar::detail::Undo unpaid{[&] { context.session.release(cost); }};
    if (is_first && !context.random.fill(lot)) {
        return nullptr;
    }
    auto made = is_first ? std::make_unique<RegisteredNodes>(context.space, lot) : nullptr;
    (is_first ? *made : *registered).make_places(missing);
    if (is_first) {
        registered = std::move(made);
    }
    unpaid.keep();
    return registered.get();
}

} // namespace

StatusCode RegisterWork::begin(ViewContext& context, const RegisterNodesRequest& request,
                               RegisterNodesResponse& response)
{
    const StatusCode status = check(context, request.nodes_to_register);
    if (status.is_good()) {
        response.registered_node_ids.reserve(request.nodes_to_register.size());
    }
    return status;
}

// A node that does not need an alias keeps its NodeId, and so does one without a free alias or that
// the user must not see: the answer does not tell them apart (Part 4, 5.9.5.1).
bool RegisterWork::go_on(ViewContext& context, const RegisterNodesRequest& request,
                         RegisterNodesResponse& response)
{
    const auto ids = request.nodes_to_register.span();
    auto& given = response.registered_node_ids;
    NodesAhead nodes{context.space};
    do {
        const NodeId& id = ids[given.size()];
        const model::NodeIndex node = nodes.find(
            ids, given.size(), [](const NodeId& itself) -> const NodeId& { return itself; });
        RegisteredNodes* const place =
            deserves_alias(context, node) ? place_for_one(context) : nullptr;
        given.push_back(place != nullptr ? place->add(node) : id);
        context.turn.spend(Turn::units_of_value);
    } while (given.size() < ids.size() && !context.turn.is_over());
    return given.size() == ids.size();
}

void RegisterWork::undo(Session& session, const RegisterNodesResponse& response)
{
    for (const NodeId& id : response.registered_node_ids) {
        if (session.registered != nullptr) {
            session.registered->remove(id);
        }
    }
}

StatusCode UnregisterWork::begin(const ViewContext& context, const UnregisterNodesRequest& request)
{
    return check(context, request.nodes_to_unregister);
}

bool UnregisterWork::go_on(ViewContext& context, const UnregisterNodesRequest& request)
{
    const auto ids = request.nodes_to_unregister.span();
    RegisteredNodes* const registered = context.session.registered.get();
    for (; registered != nullptr && done_ < ids.size() && !context.turn.is_over(); ++done_) {
        registered->remove(ids[done_]);
        context.turn.spend(Turn::units_of_value);
    }
    return registered == nullptr || done_ == ids.size();
}

} // namespace busbar::server::detail
