#pragma once

#include <cstdint>

#include <busbar/core/attribute_id.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/access_control.hpp>

/// The permissions that a node's RolePermissions grant a user (Part 3, 4.9 and 8.55).
///
/// A role is named by a well-known NodeId or by the BrowseName of its node. Every user has the role
/// Anonymous, one who has logged in also AuthenticatedUser, and those that the UserStore gave him.

namespace busbar::server::detail {

inline constexpr std::uint32_t all_permissions = UINT32_MAX;

[[nodiscard]] bool has_role(const model::AddressSpace& space, const UserIdentity& user,
                            const NodeId& role);
/// Returns whether the user is ConfigureAdmin or SecurityAdmin.
[[nodiscard]] bool is_administrator(const model::AddressSpace& space, const UserIdentity& user);
/// Returns the entries for roles that the user has.
[[nodiscard]] Array<RolePermissionType>
user_role_permissions(const model::AddressSpace& space, const UserIdentity& user,
                      const Array<RolePermissionType>& permissions);
/// Returns what a node's RolePermissions allow the user, for all his roles together;
/// all_permissions if neither the node nor its namespace has any.
[[nodiscard]] std::uint32_t user_permissions(const model::AddressSpace& space,
                                             const UserIdentity& user,
                                             const Array<RolePermissionType>& given);

/// The rights of one user to nodes over one channel. An AccessControl, the RolePermissions of a
/// node and its AccessRestrictions must all agree. Created again in each turn, since a user's roles
/// may change between two.
struct NodeRights {
    const model::AddressSpace& space;
    const UserIdentity& user;
    /// May be null.
    const AccessControl* control{nullptr};
    /// The security mode of the channel.
    MessageSecurityMode security_mode{MessageSecurityMode::None};
    /// The last RolePermissions and their result: neighbours often share theirs.
    struct Known {
        const Array<RolePermissionType>* given{nullptr};
        std::uint64_t access_changes{0};
        std::uint32_t permissions{all_permissions};
    };
    mutable Known known{};

    /// False for a node that is hidden from the user.
    [[nodiscard]] bool may_see(model::NodeIndex node) const
    {
        return (control == nullptr || control->may_browse(user, space.node_id(node))) &&
               is_permitted(PermissionType::Browse, node);
    }
    /// Good, or Bad_SecurityModeInsufficient if the channel is weaker than the node requires (Part
    /// 3, 8.56). SessionRequired is always met: there are no services without session.
    [[nodiscard]] StatusCode check_channel(model::NodeIndex node) const
    {
        return is_strong_enough(space.access_restrictions(node))
                   ? status::Good
                   : status::Bad_SecurityModeInsufficient;
    }
    /// Checks likewise for the permission Browse: references, and reading attributes other than
    /// Value and RolePermissions.
    [[nodiscard]] StatusCode check_browse_channel(model::NodeIndex node) const
    {
        constexpr auto applies =
            static_cast<unsigned>(AccessRestrictionType::ApplyRestrictionsToBrowse);
        const std::uint16_t restrictions = space.access_restrictions(node);
        return (restrictions & applies) == 0 || is_strong_enough(restrictions)
                   ? status::Good
                   : status::Bad_SecurityModeInsufficient;
    }
    [[nodiscard]] bool is_permitted(PermissionType permission, model::NodeIndex node) const
    {
        return (permissions(node) & static_cast<std::uint32_t>(permission)) != 0;
    }
    /// Returns whether the user may call an executable Method. One that is not the server's own may
    /// change as much as a Write does.
    [[nodiscard]] bool may_call(model::NodeIndex method, bool is_servers_own) const
    {
        constexpr auto current_write = static_cast<std::uint8_t>(AccessLevelType::CurrentWrite);
        return (is_servers_own || (user.access_level_mask & current_write) != 0) &&
               is_in_reach(method) &&
               (control == nullptr || control->may_call(user, space.node_id(method))) &&
               is_permitted(PermissionType::Call, method);
    }
    // For the NodeManagement services: Good, Bad_UserAccessDenied or as check_channel.

    [[nodiscard]] StatusCode check_add_node(model::NodeIndex parent) const
    {
        return check(&AccessControl::may_add_node, PermissionType::AddNode, parent);
    }
    [[nodiscard]] StatusCode check_delete_node(model::NodeIndex node) const
    {
        return check(&AccessControl::may_delete_node, PermissionType::DeleteNode, node);
    }
    [[nodiscard]] StatusCode check_add_reference(model::NodeIndex node) const
    {
        return check(&AccessControl::may_add_reference, PermissionType::AddReference, node);
    }
    [[nodiscard]] StatusCode check_remove_reference(model::NodeIndex node) const
    {
        return check(&AccessControl::may_remove_reference, PermissionType::RemoveReference, node);
    }
    /// Returns the UserAccessLevel of a Variable (Part 3, 5.6.2).
    [[nodiscard]] std::uint8_t access_level(model::NodeIndex node,
                                            const model::VariableAttributes& variable) const
    {
        if (!is_in_reach(node)) {
            return 0;
        }
        unsigned level = variable.access_level;
        level &= variable.user_access_level;
        level &= user.access_level_mask;
        level &= permitted_access(permissions(node));
        if (control != nullptr) {
            level &= control->user_access_level(user, space.node_id(node), variable.access_level);
        }
        return static_cast<std::uint8_t>(level);
    }

private:
    /// See UserIdentity::administers_only.
    [[nodiscard]] bool is_in_reach(model::NodeIndex node) const
    {
        constexpr std::uint16_t last_of_server = 1; // Part 3, 8.2.2
        return !user.administers_only || space.node_id(node).namespace_index() <= last_of_server;
    }
    /// See user_permissions.
    [[nodiscard]] std::uint32_t permissions(model::NodeIndex node) const
    {
        const Array<RolePermissionType>* const given = space.role_permissions(node);
        if (given == nullptr) {
            return all_permissions;
        }
        const std::uint64_t changes = space.journal().access_changes();
        if (given != known.given || changes != known.access_changes) {
            known = {given, changes, user_permissions(space, user, *given)};
        }
        return known.permissions;
    }

    using Question = bool (AccessControl::*)(const UserIdentity&, const NodeId&) const;

    [[nodiscard]] bool is_strong_enough(std::uint16_t restrictions) const
    {
        constexpr auto encryption =
            static_cast<unsigned>(AccessRestrictionType::EncryptionRequired);
        constexpr auto signing = static_cast<unsigned>(AccessRestrictionType::SigningRequired);
        const bool is_encrypted = security_mode == MessageSecurityMode::SignAndEncrypt;
        const bool is_signed = is_encrypted || security_mode == MessageSecurityMode::Sign;
        return ((restrictions & encryption) == 0 || is_encrypted) &&
               ((restrictions & signing) == 0 || is_signed);
    }
    [[nodiscard]] StatusCode check(Question question, PermissionType permission,
                                   model::NodeIndex node) const
    {
        if (const StatusCode weak = check_channel(node); weak.is_bad()) {
            return weak;
        }
        const bool is_allowed = control == nullptr
                                    ? is_configure_admin(user)
                                    : (control->*question)(user, space.node_id(node));
        return is_allowed && is_permitted(permission, node) ? status::Good
                                                            : status::Bad_UserAccessDenied;
    }
    /// Returns the bits of AccessLevelType that permissions allow (Part 3, 8.55).
    [[nodiscard]] static unsigned permitted_access(std::uint32_t permissions)
    {
        const auto unless = [&](PermissionType permission, AccessLevelType level) {
            return (permissions & static_cast<std::uint32_t>(permission)) == 0
                       ? static_cast<unsigned>(level)
                       : 0U;
        };
        return ~(unless(PermissionType::Read, AccessLevelType::CurrentRead) |
                 unless(PermissionType::Write, AccessLevelType::CurrentWrite) |
                 unless(PermissionType::ReadHistory, AccessLevelType::HistoryRead) |
                 unless(PermissionType::ModifyHistory, AccessLevelType::HistoryWrite));
    }
};

[[nodiscard]] constexpr bool has_access(std::uint8_t level, AccessLevelType bit)
{
    return (level & static_cast<std::uint8_t>(bit)) != 0;
}

/// Returns the status for a NodeId of no node: a null one is always invalid.
[[nodiscard]] inline StatusCode why_not_found(const NodeId& id)
{
    return id.is_null() ? status::Bad_NodeIdInvalid : status::Bad_NodeIdUnknown;
}

// AttributeWriteMask (Part 3, 8.60): the attributes of a node, other than its Value, that Write
// can replace. NodeAccess::write_mask may name more than this server can write: clients do not see
// those bits.

/// Returns the attribute's bit; 0 for one that has none.
[[nodiscard]] std::uint32_t write_mask_bit(AttributeId attribute);
/// Returns the WriteMask of the node; 0 for a constant node.
[[nodiscard]] std::uint32_t write_mask(const model::AddressSpace& space, model::NodeIndex node);
/// Returns the part of it that the user may write: RolePermissions with the permission
/// WriteRolePermissions, AccessRestrictions with that and WriteAttribute, all others with
/// WriteAttribute (Part 3, 8.55). Without CurrentWrite in his mask a user may write nothing, and if
/// no RolePermissions apply only administrators change rights. The channel is not checked.
[[nodiscard]] std::uint32_t user_write_mask(const NodeRights& rights, model::NodeIndex node);

} // namespace busbar::server::detail
