#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/password_rules.hpp>

namespace busbar::server {

/// Users in memory, with hashes of their passwords (crypto::hash_password). A login costs one hash,
/// by default some tens of milliseconds and 16.8 MB (PasswordRules::cost); an unknown name costs
/// the same as one of the users. See set_worker. Called from any thread.
class BUSBAR_API PasswordUsers final : public UserStore {
    struct User;
    struct Users;

public:
    /// Users to be set and removed together.
    class BUSBAR_API Change {
    public:
        Change();
        Change(Change&&) noexcept;
        Change& operator=(Change&&) noexcept;
        ~Change();

        /// Sets as PasswordUsers::set does.
        [[nodiscard]] Result<void> set(std::string name, std::string password_hash,
                                       UserRights rights = {});
        /// Sets as PasswordUsers::set_code does.
        [[nodiscard]] Result<void> set_code(std::string name, std::string code_hash,
                                            UserRights rights = {});
        /// Removes a user, if he exists.
        void remove(std::string name) { gone_.push_back(std::move(name)); }

    private:
        friend class PasswordUsers;

        [[nodiscard]] Result<void> put(std::string name, User user);

        std::unique_ptr<Users> set_;
        std::vector<std::string> gone_;
    };

    explicit PasswordUsers(PasswordRules rules = {});
    PasswordUsers(const PasswordUsers&) = delete;
    PasswordUsers& operator=(const PasswordUsers&) = delete;
    ~PasswordUsers() override;

    /// Adds a user with a password. Bad_InvalidArgument if name or password break the rules,
    /// Bad_EntryExists if the name exists, Bad_TooManyOperations at PasswordRules::max_users.
    [[nodiscard]] Checked<void> add(std::string_view name, std::string_view password,
                                    crypto::Random& random, UserRights rights = {});
    /// Returns Bad_UserAccessDenied if `old_password` is wrong or the user does not exist,
    /// Bad_InvalidArgument if the new one breaks the rules.
    [[nodiscard]] Checked<void> change_password(std::string_view name,
                                                std::string_view old_password,
                                                std::string_view new_password,
                                                crypto::Random& random);
    /// Returns false if the user does not exist.
    bool remove(std::string_view name);

    /// Adds or replaces a user as stored in a file, without checking the rules. Bad_InvalidArgument
    /// for an empty name or for a text that is not a hash.
    [[nodiscard]] Result<void> set(std::string name, std::string password_hash,
                                   UserRights rights = {});
    /// Sets a user whose password is a random code of at least 80 bits, see has_code().
    [[nodiscard]] Result<void> set_code(std::string name, std::string code_hash,
                                        UserRights rights = {});
    /// Applies all changes without needing memory; previously stored users are then in force.
    void apply(Change change) noexcept;
    /// Returns the hash to store for the user; empty if the user does not exist.
    [[nodiscard]] std::string password_hash(std::string_view name) const;
    /// Sets what anonymous users may do with Variables, as bits of AccessLevel.
    void set_anonymous_access(std::uint8_t access_level_mask) { anonymous_ = access_level_mask; }
    /// Sets the worker that checks passwords; null for the server's thread. The worker must have
    /// finished before this object is destroyed.
    void set_worker(Worker* worker) { worker_ = worker; }

    [[nodiscard]] Result<UserIdentity> log_in(std::string_view name,
                                              std::string_view password) override;
    [[nodiscard]] Worker* worker() override { return worker_; }
    [[nodiscard]] bool has_code(std::string_view name) const override;
    [[nodiscard]] UserIdentity anonymous() const override;

private:
    PasswordRules rules_;
    std::unique_ptr<Users> users_;
    std::uint8_t anonymous_{anonymous_reader().access_level_mask};
    Worker* worker_{nullptr};
};

} // namespace busbar::server
