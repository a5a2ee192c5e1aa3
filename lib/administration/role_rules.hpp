#pragma once

#include <busbar/administration/role_list.hpp>

/// When a rule of a role fits a session (Part 18, 4.4.1 to 4.4.4).
namespace busbar::administration::detail {

[[nodiscard]] bool fits(const RoleRules& role, const server::RoleQuestion& question);
/// Whether the role's lists of applications and endpoints allow the session to have it, however it
/// came to it (Part 18, 4.4.1).
[[nodiscard]] bool admits(const RoleRules& role, const server::RoleQuestion& question);

/// Good, Bad_InvalidArgument for a rule that makes no sense, Bad_NotSupported for a criteria type
/// that is not known here.
[[nodiscard]] StatusCode check_rule(const IdentityMappingRuleType& rule, std::size_t max_text);

} // namespace busbar::administration::detail
