#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/role_list.hpp>

/// Decides whether the rules of a role apply to a session (Part 18, 4.4.1 to 4.4.4), and keeps them
/// in a file.

namespace busbar::administration::detail {

[[nodiscard]] bool fits(const RoleRules& role, const server::RoleQuestion& question);
/// Tells whether the role's lists of applications and endpoints allow the session to have the role,
/// whichever rule gave it (Part 18, 4.4.1).
[[nodiscard]] bool admits(const RoleRules& role, const server::RoleQuestion& question);

/// Good, Bad_InvalidArgument for a rule that is not valid, Bad_NotSupported for an unknown criteria
/// type.
[[nodiscard]] StatusCode check_rule(const IdentityMappingRuleType& rule, std::size_t max_text);

/// Returns the roles of Part 3, 4.9.2 without additional rules.
[[nodiscard]] std::vector<RoleRules> well_known_roles();

[[nodiscard]] std::string document_of(const std::vector<RoleRules>& roles);
/// Reads the well-known roles with the rules of the file, followed by its other roles.
[[nodiscard]] Configured<std::vector<RoleRules>> read_roles(Storage& storage, std::string_view file,
                                                            const RoleLimits& limits);

/// The well-known roles that cannot change anything (Part 3, 4.9.2).
inline constexpr std::array<std::string_view, 4> reading_roles{"Anonymous", "AuthenticatedUser",
                                                               "TrustedApplication", "Observer"};

/// Returns the access level mask of a user with these roles (UserIdentity::access_level_mask): only
/// reading, unless one of the roles allows more.
[[nodiscard]] inline std::uint8_t access_of(const std::vector<std::string>& roles)
{
    constexpr std::uint8_t reading = 0x05; // CurrentRead and HistoryRead
    constexpr std::uint8_t everything = 0xFF;
    const bool is_more = std::any_of(roles.begin(), roles.end(), [](const std::string& role) {
        return std::find(reading_roles.begin(), reading_roles.end(), role) == reading_roles.end();
    });
    return is_more ? everything : reading;
}

} // namespace busbar::administration::detail
