#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/role_list.hpp>
#include <busbar/core/record.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// The RoleSet object (Part 18, 4.2 and 4.3) over a RoleList.
class RoleSet {
public:
    /// Raises `changed` when roles change.
    RoleSet(server::Server& server, RoleList& roles, NodeTable& table, NodeTable::Signal& changed,
            LogSink& log, const std::function<Configured<void>()>& may_change);

    /// Connects the nodes; the problem names what is missing in namespace 0.
    [[nodiscard]] Configured<void> attach();

private:
    using Change = std::function<Checked<void>(const server::MethodCall&)>;

    void bind(const std::string& role, model::NodeIndex node);
    void bind_values(const std::string& role, model::NodeIndex node);
    void bind_methods(const std::string& role, model::NodeIndex node);
    /// Binds a Method that changes the list.
    void bind_change(model::NodeIndex node, std::string_view method, Change change);
    void add_role(server::MethodCall call);
    void remove_role(server::MethodCall call);
    void remove_nodes();
    /// Adds the node of a role that is not well-known.
    [[nodiscard]] Result<model::NodeIndex> add_node(const RoleRules& role);
    [[nodiscard]] NodeId node_id(const RoleRules& role) const;
    /// Records the change; sessions then get their roles again.
    void changed(const server::MethodCall& call);
    void refuse_call(server::MethodCall& call, const Refusal& refusal);
    /// Refuses the call if users and roles cannot be changed now.
    [[nodiscard]] bool is_refused(server::MethodCall& call);

    server::Server& server_;
    model::AddressSpace& space_;
    RoleList& roles_;
    NodeTable& table_;
    NodeTable::Signal& changed_;
    /// Gives sessions their roles again.
    NodeTable::Signal& renew_roles_;
    NodeTable::Signal& remove_nodes_;
    LogSink& log_;
    const std::function<Configured<void>()>& may_change_;
    std::uint16_t own_namespace_{0};
    /// Nodes of removed roles.
    std::vector<NodeId> gone_;
};

} // namespace busbar::administration::detail
