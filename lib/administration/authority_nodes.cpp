#include "authority_nodes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/administration/authorities.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "permissions.hpp"

namespace busbar::administration {

namespace {

struct RoleOfAuthority {
    Authority authority;
    std::uint32_t role;
};
constexpr std::array roles_of_authorities{
    RoleOfAuthority{Authority::Observer, id::WellKnownRole_Observer},
    RoleOfAuthority{Authority::Operator, id::WellKnownRole_Operator},
    RoleOfAuthority{Authority::Maintainer, id::WellKnownRole_Supervisor},
    RoleOfAuthority{Authority::Designer, id::WellKnownRole_Engineer},
    RoleOfAuthority{Authority::Administrator, id::WellKnownRole_ConfigureAdmin},
    RoleOfAuthority{Authority::Administrator, id::WellKnownRole_SecurityAdmin},
};

/// Gives it more permissions, on top of what it has.
void permit(model::NodeAccess& access, std::uint32_t role, PermissionType permissions)
{
    const auto found =
        std::find_if(access.role_permissions.begin(), access.role_permissions.end(),
                     [&](const RolePermissionType& each) { return each.role_id.is(role); });
    if (found == access.role_permissions.end()) {
        access.role_permissions.push_back({NodeId{0, role}, permissions});
    } else {
        found->permissions = detail::together(found->permissions, permissions);
    }
}

/// Or for observers, who have no authority.
bool is_for_everybody(const NodeId& role)
{
    constexpr std::array roles{id::WellKnownRole_Anonymous, id::WellKnownRole_AuthenticatedUser,
                               id::WellKnownRole_TrustedApplication, id::WellKnownRole_Observer};
    return std::any_of(roles.begin(), roles.end(),
                       [&](std::uint32_t each) { return role.is(each); });
}

/// From `least` on; what everybody might is for nobody else from now on.
void permit_from(model::AddressSpace& space, model::NodeIndex node, Authority least,
                 PermissionType permissions)
{
    const model::NodeAccess* const now = space.node_access(node);
    model::NodeAccess access = now != nullptr ? model::NodeAccess{*now} : model::NodeAccess{};
    const bool is_open = access.role_permissions.is_null();
    Array<RolePermissionType> kept;
    for (const RolePermissionType& each : access.role_permissions) {
        if (!is_for_everybody(each.role_id)) {
            kept.push_back(each);
        }
    }
    access.role_permissions = std::move(kept);
    for (const auto& [authority, role] : roles_of_authorities) {
        if (authority >= least && (is_open || authority != Authority::Administrator)) {
            permit(access, role, permissions);
        }
    }
    space.set_node_access(node, std::move(access));
}

std::vector<model::NodeIndex> children(const model::AddressSpace& space, model::NodeIndex node)
{
    std::vector<model::NodeIndex> result;
    model::ReferenceCursor cursor = space.references(node);
    while (const auto reference = cursor.next()) {
        if (reference->is_forward && space.is_subtype_of(reference->type, id::HasChild)) {
            result.push_back(reference->target);
        }
    }
    return result;
}

/// Nobody changes anything by them. GetCertificates is what exports.
bool shows_something(std::string_view method)
{
    constexpr std::array<std::string_view, 7> names{
        "Open", "OpenWithMasks", "Read", "Close", "GetPosition", "SetPosition", "GetRejectedList"};
    return std::find(names.begin(), names.end(), method) != names.end();
}

/// A Method with its arguments.
void permit_call(model::AddressSpace& space, model::NodeIndex method, Authority least)
{
    permit_from(space, method, least,
                detail::together(PermissionType::Browse, PermissionType::Call));
    for (const model::NodeIndex argument : children(space, method)) {
        permit_from(space, argument, least, detail::may_see);
    }
}

/// Users are the business of those who administer them.
void show_below(model::AddressSpace& space, model::NodeIndex node)
{
    if (space.node_id(node).is(id::UserManagement)) {
        return;
    }
    if (space.node_class(node) == NodeClass::Method) {
        if (shows_something(space.browse_name(node).name.view())) {
            permit_call(space, node, Authority::Operator);
        }
        return;
    }
    permit_from(space, node, Authority::Operator, detail::may_see);
    for (const model::NodeIndex child : children(space, node)) {
        show_below(space, child);
    }
}

/// How many clients there are (seed 000, 4-2-1).
void keep_status_from_observers(model::AddressSpace& space)
{
    const model::NodeIndex summary =
        space.find(id::Server_ServerDiagnostics_ServerDiagnosticsSummary);
    if (summary == model::no_node) {
        return;
    }
    permit_from(space, summary, Authority::Operator, detail::may_see);
    for (const model::NodeIndex child : children(space, summary)) {
        permit_from(space, child, Authority::Operator, detail::may_see);
    }
}

} // namespace

std::optional<Authorities> find_authorities(std::string_view name)
{
    return name == "standard"      ? std::optional{Authorities::Standard}
           : name == "five levels" ? std::optional{Authorities::FiveLevels}
                                   : std::nullopt;
}

model::NodeAccess access_from(Authority reads, Authority acts)
{
    model::NodeAccess access;
    access.restrictions = static_cast<std::uint16_t>(AccessRestrictionType::EncryptionRequired);
    for (const auto& [authority, role] : roles_of_authorities) {
        if (authority >= reads) {
            permit(access, role, detail::may_see);
        }
        if (authority >= acts) {
            permit(access, role, detail::may_act);
        }
    }
    return access;
}

void detail::give_authorities(model::AddressSpace& space)
{
    const model::NodeIndex configuration = space.find(id::ServerConfiguration);
    if (configuration != model::no_node) {
        show_below(space, configuration);
    }
    const model::NodeIndex stop = space.find(id::Server_RequestServerStateChange);
    if (stop != model::no_node) {
        permit_call(space, stop, Authority::Designer);
    }
    keep_status_from_observers(space);
}

} // namespace busbar::administration
