#include <algorithm>
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

/// Whether an alias makes it quicker to find: a Variable that is looked up by its hash and has its
/// value behind its node.
bool deserves_alias(const ViewContext& context, model::NodeIndex node)
{
    return node != model::no_node && !context.space.is_constant(node) &&
           context.space.node_class(node) == NodeClass::Variable &&
           context.space.node_id(node).namespace_index() != 0 &&
           context.space.variable(node).source != live_values_source && context.may_see(node);
}

/// Has places for `count` aliases if the session can pay for them; null if it has none.
RegisteredNodes* places_for(ViewContext& context, std::size_t count)
{
    auto& registered = context.session.registered;
    const bool is_first = registered == nullptr;
    const std::size_t missing = is_first ? count : registered->missing(count);
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

// A node that has no use for an alias keeps its NodeId, and so does one that there is none for or
// that the user must not see: the answer does not tell them apart (Part 4, 5.9.5.1).
StatusCode register_nodes(ViewContext& context, const RegisterNodesRequest& request,
                          RegisterNodesResponse& response)
{
    const StatusCode status = check(context, request.nodes_to_register);
    if (status.is_bad()) {
        return status;
    }
    response.registered_node_ids = request.nodes_to_register;
    const auto ids = request.nodes_to_register.span();
    std::vector<model::NodeIndex> nodes;
    nodes.reserve(ids.size());
    NodesAhead ahead{context.space};
    const auto itself = [](const NodeId& id) -> const NodeId& { return id; };
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const model::NodeIndex node = ahead.find(ids, i, itself);
        nodes.push_back(deserves_alias(context, node) ? node : model::no_node);
    }
    const auto count = ids.size() - static_cast<std::size_t>(
                                        std::count(nodes.begin(), nodes.end(), model::no_node));
    RegisteredNodes* const registered = count != 0 ? places_for(context, count) : nullptr;
    for (std::size_t i = 0; registered != nullptr && i < ids.size(); ++i) {
        if (nodes[i] != model::no_node) {
            response.registered_node_ids[i] = registered->add(nodes[i]);
        }
    }
    return status;
}

StatusCode unregister_nodes(ViewContext& context, const UnregisterNodesRequest& request)
{
    const StatusCode status = check(context, request.nodes_to_unregister);
    if (status.is_good() && context.session.registered != nullptr) {
        for (const NodeId& id : request.nodes_to_unregister) {
            context.session.registered->remove(id);
        }
    }
    return status;
}

} // namespace busbar::server::detail
