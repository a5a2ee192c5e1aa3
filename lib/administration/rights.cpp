#include "rights.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "permissions.hpp"

namespace busbar::administration::detail {

namespace {

constexpr PermissionType no_permission{};

struct KnownRole {
    Roles bit;
    std::uint32_t id;
};
constexpr std::array known_roles{
    KnownRole{who::everybody, id::WellKnownRole_Anonymous},
    KnownRole{who::operator_, id::WellKnownRole_Operator},
    KnownRole{who::supervisor, id::WellKnownRole_Supervisor},
    KnownRole{who::engineer, id::WellKnownRole_Engineer},
    KnownRole{who::configure_admin, id::WellKnownRole_ConfigureAdmin},
    KnownRole{who::security_admin, id::WellKnownRole_SecurityAdmin},
};

/// A node that belongs to another thing than the node around it, by its name.
struct Placed {
    Thing within;
    std::string_view name;
    Thing thing;
};
constexpr std::array placed{
    Placed{Thing::ServerFacts, "UserManagement", Thing::UserManagement},
    Placed{Thing::UserManagement, "Users", Thing::Users},
    Placed{Thing::UserManagement, "ChangePassword", Thing::OwnPassword},
    Placed{Thing::ServerFacts, "DefaultApplicationGroup", Thing::TrustLists},
    Placed{Thing::ServerFacts, "DefaultUserTokenGroup", Thing::TrustLists},
    Placed{Thing::ServerFacts, "TransactionDiagnostics", Thing::TrustLists},
    Placed{Thing::ServerFacts, "GetRejectedList", Thing::TrustLists},
    Placed{Thing::TrustLists, "Open", Thing::TrustLists},
    Placed{Thing::TrustLists, "OpenWithMasks", Thing::TrustLists},
    Placed{Thing::TrustLists, "Read", Thing::TrustLists},
    Placed{Thing::TrustLists, "Close", Thing::TrustLists},
    Placed{Thing::TrustLists, "GetPosition", Thing::TrustLists},
    Placed{Thing::TrustLists, "SetPosition", Thing::TrustLists},
    Placed{Thing::ServerFacts, "RemoveRejectedCertificate", Thing::TrustListChanges},
    Placed{Thing::ServerFacts, "ApplyChanges", Thing::TransactionEnds},
    Placed{Thing::ServerFacts, "CancelChanges", Thing::TransactionEnds},
    Placed{Thing::ServerFacts, "ResetToServerDefaults", Thing::Reset},
};

/// Returns the thing that other Methods within a thing belong to.
Thing methods_of(Thing within)
{
    switch (within) {
    case Thing::Roles:
        return Thing::RoleRules;
    case Thing::UserManagement:
        return Thing::Users;
    case Thing::ServerFacts:
        return Thing::OwnCertificate;
    case Thing::TrustLists:
        return Thing::TrustListChanges;
    default:
        return within;
    }
}

Thing thing_of(const model::AddressSpace& space, model::NodeIndex node, Thing within)
{
    const auto found = std::find_if(placed.begin(), placed.end(), [&](const Placed& each) {
        return each.within == within && space.browse_name(node).name.view() == each.name;
    });
    if (found != placed.end()) {
        return found->thing;
    }
    const bool is_of_role = within == Thing::Roles && space.node_class(node) != NodeClass::Object;
    return is_of_role || space.node_class(node) == NodeClass::Method ? methods_of(within) : within;
}

/// Returns the permissions of the role with this bit (Part 3, 8.55); none if it has no right.
PermissionType permissions_of(const Rights& rights, Roles role, NodeClass node_class,
                              bool is_argument)
{
    const bool calls = (rights.call & role) != 0;
    const bool sees = (rights.see & role) != 0 || calls;
    PermissionType given = sees ? PermissionType::Browse : no_permission;
    if (node_class == NodeClass::Variable) {
        const bool writes = (rights.write & role) != 0 && !is_argument;
        given = sees ? may_see : given;
        return writes ? together(may_see, PermissionType::Write) : given;
    }
    return calls ? together(given, PermissionType::Call) : given;
}

const Rights& rights_with(const RightOfThing& right, Authorities authorities)
{
    return authorities == Authorities::FiveLevels ? right.five_levels : right.standard;
}

void permit(Array<RolePermissionType>& all, const NodeId& role, PermissionType permissions)
{
    const auto found = std::find_if(all.begin(), all.end(), [&](const RolePermissionType& each) {
        return each.role_id == role;
    });
    if (found == all.end()) {
        all.push_back({role, permissions});
    } else {
        found->permissions = together(found->permissions, permissions);
    }
}

/// Returns the permissions of other roles that stay; a role without any right loses them.
Array<RolePermissionType> kept_of(const model::NodeAccess& before, const Rights& rights,
                                  NodeClass node_class, bool is_argument)
{
    Array<RolePermissionType> kept;
    kept.clear(); // not null: if no role stays, no user has access
    for (const RolePermissionType& each : before.role_permissions) {
        const auto known =
            std::find_if(known_roles.begin(), known_roles.end(),
                         [&](const KnownRole& role) { return each.role_id.is(role.id); });
        if (known != known_roles.end() &&
            permissions_of(rights, known->bit, node_class, is_argument) != no_permission) {
            kept.push_back(each);
        }
    }
    return kept;
}

void give(model::AddressSpace& space, model::NodeIndex node, Thing thing, Authorities authorities,
          bool is_argument)
{
    const RightOfThing& right = right_of(thing);
    const Rights& rights = rights_with(right, authorities);
    const NodeClass node_class = space.node_class(node);
    const model::NodeAccess* const now = space.node_access(node);
    model::NodeAccess access = now != nullptr ? model::NodeAccess{*now} : model::NodeAccess{};
    access.role_permissions = kept_of(access, rights, node_class, is_argument);
    for (const KnownRole& role : known_roles) {
        const PermissionType given = permissions_of(rights, role.bit, node_class, is_argument);
        if (given != no_permission) {
            permit(access.role_permissions, NodeId{0, role.id}, given);
        }
    }
    if (right.channel != over::any) {
        access.restrictions = right.channel;
    }
    space.set_node_access(node, std::move(access));
}

std::vector<model::NodeIndex> children_of(const model::AddressSpace& space, model::NodeIndex node)
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

void give_below(model::AddressSpace& space, model::NodeIndex node, Thing thing,
                Authorities authorities, bool is_argument)
{
    give(space, node, thing, authorities, is_argument);
    const bool is_method = space.node_class(node) == NodeClass::Method;
    for (const model::NodeIndex child : children_of(space, node)) {
        give_below(space, child, is_method ? thing : thing_of(space, child, thing), authorities,
                   is_method);
    }
}

} // namespace

model::NodeAccess access_of(Thing thing, NodeClass node_class, const NamedRoles& roles,
                            bool is_argument, Authorities authorities)
{
    const RightOfThing& right = right_of(thing);
    const Rights& rights = rights_with(right, authorities);
    model::NodeAccess access;
    access.restrictions = right.channel;
    access.role_permissions.clear(); // not null
    const auto permit_one = [&](Roles bit, const NodeId& role) {
        const PermissionType given = permissions_of(rights, bit, node_class, is_argument);
        if (given != no_permission) {
            permit(access.role_permissions, role, given);
        }
    };
    for (const KnownRole& role : known_roles) {
        permit_one(role.bit, NodeId{0, role.id});
    }
    for (const NodeId& role : roles.readers) {
        permit_one(who::readers, role);
    }
    for (const NodeId& role : roles.writers) {
        permit_one(who::writers, role);
    }
    return access;
}

void give_rights(model::AddressSpace& space, model::NodeIndex node, Thing thing,
                 Authorities authorities)
{
    if (node != model::no_node) {
        give_below(space, node, thing, authorities, false);
    }
}

void give_rights(model::AddressSpace& space, Authorities authorities)
{
    give_rights(space, space.find(id::ServerConfiguration), Thing::ServerFacts, authorities);
    give_rights(space, space.find(id::Server_ServerCapabilities_RoleSet), Thing::Roles,
                authorities);
    give_rights(space, space.find(id::Server_RequestServerStateChange), Thing::StateChange,
                authorities);
    give_rights(space, space.find(id::Server_ServerDiagnostics_ServerDiagnosticsSummary),
                Thing::ServerStatus, authorities);
}

} // namespace busbar::administration::detail
