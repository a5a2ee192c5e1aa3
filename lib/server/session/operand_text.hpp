#pragma once

#include <cstddef>
#include <string>

#include <busbar/core/node_id.hpp>

#include "return_diagnostics.hpp"

/// Describes the subjects of a request's operations, and adds their diagnostics, for every service.
namespace busbar::server::detail {

/// Describes the operation at `i`; empty if its result says everything.
template <typename Request>
std::string operand_text(const Request& request, std::size_t i)
{
    const auto attribute = [](const auto& of) {
        return to_string(of.node_id) + ", attribute " + std::to_string(of.attribute_id);
    };
    if constexpr (requires { request.nodes_to_read; }) {
        return attribute(request.nodes_to_read[i]);
    } else if constexpr (requires { request.nodes_to_write; }) {
        return attribute(request.nodes_to_write[i]);
    } else if constexpr (requires { request.items_to_create; }) {
        return attribute(request.items_to_create[i].item_to_monitor);
    } else if constexpr (requires { request.nodes_to_browse; }) {
        return to_string(request.nodes_to_browse[i].node_id);
    } else if constexpr (requires { request.browse_paths; }) {
        return to_string(request.browse_paths[i].starting_node);
    } else if constexpr (requires { request.methods_to_call; }) {
        return to_string(request.methods_to_call[i].method_id) + " of " +
               to_string(request.methods_to_call[i].object_id);
    } else if constexpr (requires { request.nodes_to_add; }) {
        return to_string(request.nodes_to_add[i].browse_name);
    } else if constexpr (requires { request.nodes_to_delete; }) {
        return to_string(request.nodes_to_delete[i].node_id);
    } else if constexpr (requires { request.references_to_add; }) {
        return to_string(request.references_to_add[i].source_node_id);
    } else if constexpr (requires { request.references_to_delete; }) {
        return to_string(request.references_to_delete[i].source_node_id);
    } else if constexpr (requires { request.items_to_modify; }) {
        return "item " + std::to_string(request.items_to_modify[i].monitored_item_id);
    } else if constexpr (requires { request.monitored_item_ids; }) {
        return "item " + std::to_string(request.monitored_item_ids[i]);
    } else if constexpr (requires { request.subscription_ids; }) {
        return "Subscription " + std::to_string(request.subscription_ids[i]);
    } else {
        return {};
    }
}

[[nodiscard]] inline StatusCode status_of(StatusCode result)
{
    return result;
}
template <typename Result>
requires requires(const Result& result)
{
    result.status_code;
}
[[nodiscard]] StatusCode status_of(const Result& result)
{
    return result.status_code;
}

/// Adds the diagnostics of its operations to the response, if it has any.
template <typename Request, typename Response>
void diagnose([[maybe_unused]] ReturnDiagnostics& diagnostics,
              [[maybe_unused]] const Request& request, [[maybe_unused]] Response& response)
{
    [[maybe_unused]] const auto of = [&](const auto& results, const auto& operand) {
        return diagnostics.of_operations(
            results.size(), [&](std::size_t i) { return status_of(results[i]); }, operand);
    };
    if constexpr (requires { response.diagnostic_infos; }) {
        response.diagnostic_infos =
            of(response.results, [&](std::size_t i) { return operand_text(request, i); });
    } else if constexpr (requires { response.add_diagnostic_infos; }) {
        const auto item = [](std::uint32_t id) { return "item " + std::to_string(id); };
        response.add_diagnostic_infos =
            of(response.add_results, [&](std::size_t i) { return item(request.links_to_add[i]); });
        response.remove_diagnostic_infos = of(response.remove_results, [&](std::size_t i) {
            return item(request.links_to_remove[i]);
        });
    }
}

} // namespace busbar::server::detail
