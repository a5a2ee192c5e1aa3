#include "permissions.hpp"

#include <algorithm>

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

} // namespace busbar::administration::detail
