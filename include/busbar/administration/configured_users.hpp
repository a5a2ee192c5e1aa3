#pragma once

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::administration {

/// The description by which clients distinguish the accounts of a configuration file.
inline constexpr std::string_view of_configuration = "of the configuration file";

/// A user with a password that the program itself provides.
struct ConfiguredUser {
    std::string name;
    /// Names of roles.
    std::vector<std::string> roles;
    /// Tells administrators where the user comes from.
    std::string description{of_configuration};
    /// Does not count as an administrator, such as the account of a setup.
    bool is_temporary{false};
};

/// The users of a program's configuration with their roles. Administrators see them, and cannot
/// change them online. The UserList and the RoleList of a server share one object, so that all
/// Methods treat these users alike. Called from any thread.
class BUSBAR_API ConfiguredUsers {
public:
    /// Replaces all previous users. A user with a token that claims one of `token_roles` has that
    /// role.
    void replace(std::vector<ConfiguredUser> users, std::vector<std::string> token_roles = {});

    [[nodiscard]] std::vector<ConfiguredUser> users() const;
    /// True if the configuration has this user.
    [[nodiscard]] bool has(std::string_view user) const;
    /// Returns whether a user who is not temporary has the role SecurityAdmin.
    [[nodiscard]] bool has_administrator() const;
    /// Returns the rules by which the configuration grants the role (Part 18, 4.4.2).
    [[nodiscard]] std::vector<IdentityMappingRuleType> identities_of(std::string_view role) const;

private:
    mutable std::mutex mutex_;
    std::vector<ConfiguredUser> users_;
    std::vector<std::string> token_roles_;
};

} // namespace busbar::administration
