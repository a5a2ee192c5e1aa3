#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/role_list.hpp>

/// How roles lie in their file.
namespace busbar::administration::detail {

/// Those of Part 3, 4.9.2, without further rules.
[[nodiscard]] std::vector<RoleRules> well_known_roles();

[[nodiscard]] std::string document_of(const std::vector<RoleRules>& roles);
/// The well-known roles with the rules of the file, and its other roles behind them.
[[nodiscard]] Configured<std::vector<RoleRules>> read_roles(Storage& storage, std::string_view file,
                                                            const RoleLimits& limits);

} // namespace busbar::administration::detail
