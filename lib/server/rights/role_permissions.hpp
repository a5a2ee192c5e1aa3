#pragma once

#include <cstdint>

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

} // namespace busbar::server::detail
