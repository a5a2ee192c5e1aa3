#include "permissions.hpp"

#include <algorithm>

#include <busbar/server/running_server.hpp>

namespace busbar::administration::detail {

bool may(PermissionType permission, const model::AddressSpace& space, model::NodeIndex node,
         const server::UserIdentity& user)
{
    const auto* const given = space.role_permissions(node);
    return given == nullptr ||
           std::any_of(given->begin(), given->end(), [&](const RolePermissionType& each) {
               const model::NodeIndex role = space.find(each.role_id);
               return has(each.permissions, permission) && role != model::no_node &&
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

StatusCode check_still(server::Server& server, const Holder& holder, const NodeId& object,
                       const NodeId& method)
{
    return is_there(server, holder)
               ? server::RunningServer{server}.check_call(holder.session, object, method)
               : StatusCode{status::Bad_SessionClosed};
}

} // namespace busbar::administration::detail
