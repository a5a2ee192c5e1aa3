#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/role_list.hpp>

/// Reads and writes the file of roles.
namespace busbar::administration::detail {

/// Returns the roles of Part 3, 4.9.2 without additional rules.
[[nodiscard]] std::vector<RoleRules> well_known_roles();

[[nodiscard]] std::string document_of(const std::vector<RoleRules>& roles);
/// Reads the well-known roles with the rules of the file, followed by its other roles.
[[nodiscard]] Configured<std::vector<RoleRules>> read_roles(Storage& storage, std::string_view file,
                                                            const RoleLimits& limits);

} // namespace busbar::administration::detail
