#pragma once

#include <busbar/administration/role_list.hpp>

/// Decides whether the rules of a role apply to a session (Part 18, 4.4.1 to 4.4.4).
namespace busbar::administration::detail {

[[nodiscard]] bool fits(const RoleRules& role, const server::RoleQuestion& question);
/// Tells whether the role's lists of applications and endpoints allow the session to have the role,
/// whichever rule gave it (Part 18, 4.4.1).
[[nodiscard]] bool admits(const RoleRules& role, const server::RoleQuestion& question);

/// Good, Bad_InvalidArgument for a rule that is not valid, Bad_NotSupported for an unknown criteria
/// type.
[[nodiscard]] StatusCode check_rule(const IdentityMappingRuleType& rule, std::size_t max_text);

} // namespace busbar::administration::detail
