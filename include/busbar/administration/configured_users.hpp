#pragma once

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::administration {

/// The description by which clients tell the accounts of a configuration file from others.
inline constexpr std::string_view of_configuration = "of the configuration file";

/// A user with a password whom the program itself brings.
struct ConfiguredUser {
    std::string name;
    /// Names of roles.
    std::vector<std::string> roles;
    /// Says to administrators where the user comes from.
    std::string description{of_configuration};
    /// Is not an administrator to count on, such as the account of a setup.
    bool is_temporary{false};
};

/// Whom a program's configuration lets in with which roles. Administrators see them, and cannot
/// change them online. The UserList and the RoleList of a server share one object, so that all
/// Methods treat these users alike. Any thread.
class BUSBAR_API ConfiguredUsers {
public:
    /// Takes the place of all before. Who has a token that claims one of `token_roles` has that
    /// role.
    void replace(std::vector<ConfiguredUser> users, std::vector<std::string> token_roles = {});

    [[nodiscard]] std::vector<ConfiguredUser> users() const;
    [[nodiscard]] bool has(std::string_view user) const;
    /// Whether one has the role SecurityAdmin, and stays.
    [[nodiscard]] bool has_administrator() const;
    /// The rules by which the configuration gives the role (Part 18, 4.4.2).
    [[nodiscard]] std::vector<IdentityMappingRuleType> identities_of(std::string_view role) const;

private:
    mutable std::mutex mutex_;
    std::vector<ConfiguredUser> users_;
    std::vector<std::string> token_roles_;
};

} // namespace busbar::administration
