#pragma once

#include <busbar/core/function_ref.hpp>
#include <busbar/core/node_id.hpp>

namespace busbar::server::detail {

/// Calls `visit` for each NodeId in the request, of any service, that may belong to a Variable with
/// an alias of RegisterNodes, until it returns false; returns the last result. Of the services that
/// accept aliases directly, those with NodeIds in records are included.
template <typename Request>
bool visit_node_ids([[maybe_unused]] Request& request,
                    [[maybe_unused]] FunctionRef<bool(NodeId&)> visit)
{
    [[maybe_unused]] const auto each = [](auto& items, auto one) {
        for (auto& item : items) {
            if (!one(item)) {
                return false;
            }
        }
        return true;
    };
    if constexpr (requires { request.nodes_to_write; }) {
        return each(request.nodes_to_write, [&](auto& item) { return visit(item.node_id); });
    } else if constexpr (requires { request.items_to_create; }) {
        return each(request.items_to_create,
                    [&](auto& item) { return visit(item.item_to_monitor.node_id); });
    } else if constexpr (requires { request.nodes_to_add; }) {
        return each(request.nodes_to_add,
                    [&](auto& item) { return visit(item.parent_node_id.node_id); });
    } else if constexpr (requires { request.nodes_to_delete; }) {
        return each(request.nodes_to_delete, [&](auto& item) { return visit(item.node_id); });
    } else if constexpr (requires { request.references_to_add; }) {
        return each(request.references_to_add, [&](auto& item) {
            return visit(item.source_node_id) && visit(item.target_node_id.node_id);
        });
    } else if constexpr (requires { request.references_to_delete; }) {
        return each(request.references_to_delete, [&](auto& item) {
            return visit(item.source_node_id) && visit(item.target_node_id.node_id);
        });
    } else {
        return true;
    }
}

} // namespace busbar::server::detail
