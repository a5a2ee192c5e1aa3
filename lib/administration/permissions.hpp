#pragma once

#include <cstdint>

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

} // namespace busbar::administration::detail
