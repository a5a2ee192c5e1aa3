#include "permissions.hpp"

#include <algorithm>

#include <busbar/server/running_server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

bool may_call(const model::AddressSpace& space, model::NodeIndex method,
              const server::UserIdentity& user)
{
    const auto* const given = space.role_permissions(method);
    return given == nullptr ||
           std::any_of(given->begin(), given->end(), [&](const RolePermissionType& each) {
               const model::NodeIndex role = space.find(each.role_id);
               return has(each.permissions, PermissionType::Call) && role != model::no_node &&
                      std::find(user.roles.begin(), user.roles.end(),
                                space.browse_name(role).name.view()) != user.roles.end();
           });
}

Holder holder_of(server::Server& server, const NodeId& session)
{
    const server::RunningServer running{server};
    return {session, running.user_number(session).value_or(0), running.share_key(session)};
}

bool is_there(server::Server& server, const Holder& holder)
{
    return server::RunningServer{server}.user_number(holder.session) == holder.user;
}

model::NodeAccess access_of_roles(const std::vector<NodeId>& readers,
                                  const std::vector<NodeId>& writers, PermissionType permissions,
                                  bool changes)
{
    model::NodeAccess access;
    access.restrictions = static_cast<std::uint16_t>(AccessRestrictionType::EncryptionRequired);
    access.role_permissions.clear(); // not null: nobody, if there are no roles
    for (const NodeId& role : writers) {
        access.role_permissions.push_back({role, permissions});
    }
    for (const NodeId& role : readers) {
        const bool is_there = std::find(writers.begin(), writers.end(), role) != writers.end();
        if (!changes && !is_there) {
            access.role_permissions.push_back({role, permissions});
        }
    }
    return access;
}

void require_encryption(model::AddressSpace& space, model::NodeIndex method)
{
    for (const model::NodeIndex node : {method, child_of(space, method, "InputArguments"),
                                        child_of(space, method, "OutputArguments")}) {
        const model::NodeAccess* const before =
            node != model::no_node ? space.node_access(node) : nullptr;
        if (before != nullptr) {
            model::NodeAccess access{*before};
            access.restrictions = static_cast<std::uint16_t>(
                before->restrictions.value_or(0) |
                static_cast<std::uint16_t>(AccessRestrictionType::EncryptionRequired));
            space.set_node_access(node, std::move(access));
        }
    }
}

} // namespace busbar::administration::detail
