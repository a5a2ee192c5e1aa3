#pragma once

#include <busbar/core/types.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/limits.hpp>

#include "client_nodes.hpp"
#include "server/rights/node_rights.hpp"

namespace busbar::server::detail {

/// The needs of the NodeManagement services for one request.
struct NodeManagementContext {
    model::AddressSpace& space;
    NodeRights rights;
    const ServerLimits& limits;
    ClientNodes& client_nodes;
    /// The namespace of NodeIds that the server chooses.
    std::uint16_t own_namespace;
    /// The name of this server in references to servers.
    const std::string& application_uri;
    /// Work that one request may cause.
    std::size_t visits_left{10'000'000};

    /// Returns the node, if it exists and the user may see it, else no_node.
    [[nodiscard]] model::NodeIndex find(const NodeId& id) const
    {
        const model::NodeIndex node = space.find(id);
        return node != model::no_node && rights.may_see(node) ? node : model::no_node;
    }
    /// Returns the same for a node of this server.
    [[nodiscard]] model::NodeIndex find(const ExpandedNodeId& id) const
    {
        return id.is_local() ? find(id.node_id) : model::no_node;
    }
    /// Returns the ReferenceType, if it may be used for references, else no_node.
    [[nodiscard]] model::NodeIndex find_reference_type(const NodeId& id) const
    {
        const model::NodeIndex type = find(id);
        const bool is_usable = type != model::no_node &&
                               space.node_class(type) == NodeClass::ReferenceType &&
                               !space.is_abstract(type);
        return is_usable ? type : model::no_node;
    }
};

} // namespace busbar::server::detail
