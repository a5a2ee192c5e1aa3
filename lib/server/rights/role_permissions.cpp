#include "node_rights.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

namespace {

/// A small namespace 0 does not have their nodes (Part 3, 4.9.2).
std::string_view well_known_name(const NodeId& role)
{
    struct WellKnown {
        std::uint32_t id;
        std::string_view name;
    };
    static constexpr std::array roles{
        WellKnown{id::WellKnownRole_Anonymous, "Anonymous"},
        WellKnown{id::WellKnownRole_AuthenticatedUser, "AuthenticatedUser"},
        WellKnown{id::WellKnownRole_TrustedApplication, "TrustedApplication"},
        WellKnown{id::WellKnownRole_Observer, "Observer"},
        WellKnown{id::WellKnownRole_Operator, "Operator"},
        WellKnown{id::WellKnownRole_Engineer, "Engineer"},
        WellKnown{id::WellKnownRole_Supervisor, "Supervisor"},
        WellKnown{id::WellKnownRole_ConfigureAdmin, "ConfigureAdmin"},
        WellKnown{id::WellKnownRole_SecurityAdmin, "SecurityAdmin"},
    };
    const auto* const found = std::find_if(roles.begin(), roles.end(),
                                           [&](const WellKnown& each) { return role.is(each.id); });
    return found == roles.end() ? std::string_view{} : found->name;
}

} // namespace

bool has_role(const model::AddressSpace& space, const UserIdentity& user, const NodeId& role)
{
    if (role.is(id::WellKnownRole_Anonymous)) {
        return true;
    }
    if (role.is(id::WellKnownRole_AuthenticatedUser) &&
        user.token_type != UserTokenType::Anonymous && !user.must_change_password) {
        return true;
    }
    std::string_view name = well_known_name(role);
    const model::NodeIndex node = name.empty() ? space.find(role) : model::no_node;
    const QualifiedName browse_name =
        node == model::no_node ? QualifiedName{} : space.browse_name(node);
    name = name.empty() ? browse_name.name.view() : name;
    return !name.empty() &&
           std::find(user.roles.begin(), user.roles.end(), name) != user.roles.end();
}

bool is_administrator(const model::AddressSpace& space, const UserIdentity& user)
{
    return is_configure_admin(user) ||
           has_role(space, user, NodeId{0, id::WellKnownRole_SecurityAdmin});
}

Array<RolePermissionType> user_role_permissions(const model::AddressSpace& space,
                                                const UserIdentity& user,
                                                const Array<RolePermissionType>& permissions)
{
    Array<RolePermissionType> of_user;
    of_user.clear(); // not null
    for (const RolePermissionType& each : permissions) {
        if (has_role(space, user, each.role_id)) {
            of_user.push_back(each);
        }
    }
    return of_user;
}

std::uint32_t user_permissions(const model::AddressSpace& space, const UserIdentity& user,
                               const Array<RolePermissionType>& given)
{
    std::uint32_t permissions = 0;
    for (const RolePermissionType& each : given) {
        if (has_role(space, user, each.role_id)) {
            permissions |= static_cast<std::uint32_t>(each.permissions);
        }
    }
    return permissions;
}

} // namespace busbar::server::detail
