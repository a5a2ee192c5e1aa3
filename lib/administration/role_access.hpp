#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::administration::detail {

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
