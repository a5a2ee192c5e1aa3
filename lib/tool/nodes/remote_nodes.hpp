#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <busbar/core/attribute_id.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/types/view.hpp>

#include "tool/connection/connection.hpp"

namespace busbar::tool {

/// A node of a server.
struct RemoteNode {
    NodeId id;
    NodeClass node_class{NodeClass::Unspecified};
    /// The node's attributes that could be read.
    std::unordered_map<AttributeId, Variant> attributes;
    /// In both directions.
    Array<ReferenceDescription> references;

    /// The attribute if it is a T, else `otherwise`.
    template <typename T>
    [[nodiscard]] T get(AttributeId attribute, T otherwise = {}) const
    {
        const auto found = attributes.find(attribute);
        return found == attributes.end() ? otherwise : found->second.value_or<T>(otherwise);
    }
};

struct RemoteNodes {
    std::vector<RemoteNode> nodes;
    /// False if a failure, or a limit of a million nodes, kept something out.
    bool is_complete{true};
};

/// All nodes of the server that are not in namespace 0, found from the root and along all their
/// references. Values are read of the nodes for which `has_value` is true alone. Tells how far it
/// is, on a terminal.
[[nodiscard]] RemoteNodes read_remote_nodes(Context& context, Connection& connection,
                                            FunctionRef<bool(const NodeId&)> has_value);

/// Removes what describes the sessions and Subscriptions of the moment, the reader's own among them
/// (Part 5, 6.3.3 and 6.3.5): nodes below SessionsDiagnosticsSummary and
/// SubscriptionDiagnosticsArray.
void leave_out_diagnostics(std::vector<RemoteNode>& nodes);

/// Gives nodes without any inverse reference those that the forward references of others imply:
/// some servers tell of the encodings of a DataType at the DataType only.
void adopt_orphans(std::vector<RemoteNode>& nodes);

} // namespace busbar::tool
