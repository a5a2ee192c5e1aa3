#pragma once

#include <cstdint>
#include <vector>

#include <busbar/model/address_space.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::administration::detail {

/// Both of them (Part 3, 8.55).
[[nodiscard]] constexpr PermissionType together(PermissionType a, PermissionType b)
{
    return PermissionType{static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b)};
}

[[nodiscard]] constexpr bool has(PermissionType all, PermissionType one)
{
    return together(all, one) == all;
}

inline constexpr PermissionType may_see = together(PermissionType::Browse, PermissionType::Read);
inline constexpr PermissionType may_act = together(PermissionType::Write, PermissionType::Call);

/// Whether one of the user's roles may call the Method, where namespace 0 has all roles.
[[nodiscard]] bool may_call(const model::AddressSpace& space, model::NodeIndex method,
                            const server::UserIdentity& user);

/// These permissions for readers and writers, or for writers alone where something `changes`; over
/// encrypted channels.
[[nodiscard]] model::NodeAccess access_of_roles(const std::vector<NodeId>& readers,
                                                const std::vector<NodeId>& writers,
                                                PermissionType permissions, bool changes);

} // namespace busbar::administration::detail
