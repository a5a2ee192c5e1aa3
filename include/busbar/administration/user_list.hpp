#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/password_users.hpp>

namespace busbar::administration {

class ConfiguredUsers;
struct ConfiguredUser;

/// The bits of UserConfigurationMask (Part 18, 5.2.3).
namespace user_bit {
/// RemoveUser refuses to remove the user.
inline constexpr std::uint32_t no_delete = 1;
/// Such a user cannot log in, as if he did not exist.
inline constexpr std::uint32_t disabled = 2;
/// The user cannot change his own password.
inline constexpr std::uint32_t no_change_by_user = 4;
/// Excludes no_change_by_user.
inline constexpr std::uint32_t must_change_password = 8;
} // namespace user_bit

/// A user with a password.
struct User {
    std::string name{};
    /// See crypto::hash_password.
    std::string password_hash{};
    /// user_bit.
    std::uint32_t configuration{0};
    std::string description;
    /// Names of roles, in addition to those by the rules of the RoleSet.
    std::vector<std::string> roles;
};

/// The changes of ModifyUser; an empty member is not changed.
struct UserChange {
    std::optional<std::string_view> password;
    std::optional<std::uint32_t> configuration;
    std::optional<std::string_view> description;
    std::optional<std::vector<std::string>> roles;
};

/// The users that administrators add, change and remove while a server runs (Part 18, 5), kept in a
/// file of a Storage. A change is completely in the file, or not made at all; it then applies to
/// the next login.
///
/// Does not check the right to make a change. Called from any thread; each change takes as long as
/// a hash of a password and the Storage do.
class BUSBAR_API UserList {
public:
    /// Returns true if the user is an administrator, by his roles or by rules; called under a lock,
    /// on any thread.
    using IsAdministrator = std::function<bool(const User&)>;

    /// `users` gets the users of the list; other names in it are not managed by this list and
    /// cannot be added. All except `rules` must outlive this object. `is_administrator` is needed
    /// if there are roles by rules: without it, a user with the role SecurityAdmin is one.
    /// `configured` are additional users, who take precedence over those of the same name and
    /// cannot be changed; may be null.
    UserList(Storage& storage, std::string file, server::PasswordRules rules,
             server::PasswordUsers& users, IsAdministrator is_administrator = {},
             const ConfiguredUsers* configured = nullptr);

    /// Reads the file; without a file there are no users. The problem names the file and the error
    /// in it, and the list does not change then.
    [[nodiscard]] Configured<void> load();

    /// In the order of their names.
    [[nodiscard]] std::vector<User> users() const;
    /// Returns them together with the configured ones, as users without a hash who have no_delete
    /// and no_change_by_user.
    [[nodiscard]] std::vector<User> all_users() const;
    /// Returns nothing if there is no such user.
    [[nodiscard]] std::optional<User> find(std::string_view name) const;
    /// True if a user who can log in is an administrator, of the list or configured.
    [[nodiscard]] bool has_administrator() const;
    [[nodiscard]] const server::PasswordRules& rules() const { return rules_; }

    // Refusals have the status of the Methods of Part 18, and never contain a password. For all of
    // them: Bad_ResourceUnavailable if the Storage fails, Bad_ConfigurationError for bits that
    // exclude each other, Bad_NotSupported for unknown bits and for a configured user,
    // Bad_OutOfRange for a password that breaks the rules.

    /// Part 18, 5.2.5: Bad_AlreadyExists, Bad_InvalidArgument for a name that breaks the rules,
    /// Bad_ResourceUnavailable at PasswordRules::max_users.
    [[nodiscard]] Checked<void> add(User user, std::string_view password, crypto::Random& random);
    /// Part 18, 5.2.6: Bad_NotFound. Bad_RequestNotAllowed if no administrator would be left.
    [[nodiscard]] Checked<void> modify(std::string_view name, const UserChange& change,
                                       crypto::Random& random);
    /// Part 18, 5.2.7: Bad_NotFound, Bad_NotSupported for a user with no_delete,
    /// Bad_RequestNotAllowed for the last administrator.
    [[nodiscard]] Checked<void> remove(std::string_view name);
    /// Part 18, 5.2.8, called by the user himself: Bad_IdentityTokenInvalid if `old_password` is
    /// wrong, Bad_NotSupported for a user with no_change_by_user, Bad_AlreadyExists if both are
    /// equal.
    [[nodiscard]] Checked<void> change_password(std::string_view name,
                                                std::string_view old_password,
                                                std::string_view new_password,
                                                crypto::Random& random);

    /// A change whose password has been hashed; calling it makes the change, once. The list must
    /// outlive it.
    using Prepared = std::function<Checked<void>()>;

    // The same in two steps: these hash and compare passwords, which takes time, and change
    // nothing.

    [[nodiscard]] Checked<Prepared> prepare_add(User user, std::string_view password,
                                                crypto::Random& random);
    [[nodiscard]] Checked<Prepared> prepare_modify(std::string_view name, const UserChange& change,
                                                   crypto::Random& random);
    [[nodiscard]] Checked<Prepared> prepare_change_password(std::string_view name,
                                                            std::string_view old_password,
                                                            std::string_view new_password,
                                                            crypto::Random& random);

private:
    [[nodiscard]] bool has_administrator_in(const std::vector<User>& users) const;
    [[nodiscard]] bool is_administrator(const User& user) const;
    [[nodiscard]] std::vector<ConfiguredUser> configured() const;
    [[nodiscard]] bool is_configured(std::string_view name) const;
    [[nodiscard]] Checked<std::string> hash(std::string_view name, std::string_view password,
                                            crypto::Random& random) const;
    [[nodiscard]] Checked<void> insert(User user);
    /// Puts what `apply` makes of the user in force.
    [[nodiscard]] Checked<void> change(std::string_view name,
                                       const std::function<Checked<void>(User&)>& apply);
    /// Writes the file, and then puts `users` in force.
    [[nodiscard]] Checked<void> replace(std::vector<User> users);
    [[nodiscard]] server::PasswordUsers::Change publication(const std::vector<User>& users) const;
    void publish(std::vector<User> users, server::PasswordUsers::Change change);

    Storage* storage_;
    std::string file_;
    server::PasswordRules rules_;
    server::PasswordUsers* passwords_;
    IsAdministrator is_administrator_;
    const ConfiguredUsers* configured_;
    /// Serializes changes; held while waiting for the Storage.
    std::mutex change_mutex_;
    /// Protects changes of users_, and reads of it other than for a change. Never held while
    /// waiting: a thread that blocks the Storage may read the users.
    mutable std::mutex mutex_;
    std::vector<User> users_;
};

} // namespace busbar::administration
