#pragma once

#include <busbar/core/storage_folder.hpp>
#include <busbar/crypto/store_validator.hpp>
#include <busbar/server/user_directory.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// Admits clients and users: has the trust lists of clients and, separately, of users, and the
/// users themselves.
class Admission {
public:
    /// Creates missing folders in `files`, the folder of certificates. Throws ConfigError. `files`
    /// and `log` must outlive this object.
    Admission(const ControllerConfig& config, Storage& files, LogSink& log);

    [[nodiscard]] crypto::CertificateValidator& clients();
    [[nodiscard]] server::UserStore& users() { return users_; }
    /// The users that are admitted now.
    [[nodiscard]] const UserConfig& user_config() const { return config_; }
    [[nodiscard]] server::PasswordUsers& passwords() { return users_.passwords(); }
    [[nodiscard]] crypto::CertificateStore& client_store() { return client_store_; }
    /// Null if no user has a certificate.
    [[nodiscard]] crypto::CertificateStore* user_store()
    {
        return config_.certified ? &user_store_ : nullptr;
    }
    /// Sets the access of anonymous users; without one endpoints do not admit them. The caller must
    /// end their sessions.
    void let_anonymous_in(std::optional<AccountAccess> access);
    /// Users who are admitted together.
    struct Users {
        UserConfig config;
        server::PasswordUsers::Change accounts;
        server::UserDirectory::RoleAccess roles;
        std::optional<crypto::JwtRules> rules;
    };
    /// Returns `users` for admit(). Throws a ConfigError that begins with `file` if kinds of user,
    /// other than anonymous ones, were added or removed: endpoints offer the same kinds since the
    /// start.
    [[nodiscard]] Users prepare(UserConfig users, const std::string& file) const;
    /// Admits only these users from now on. Needs no memory.
    void admit(Users users) noexcept;
    /// Reads the trust lists again, which also happens when files change, and logs changes. Returns
    /// a text with the numbers of certificates.
    [[nodiscard]] std::string read_certificates(DateTime now);
    /// Logs certificates that were added to the folders of the trust lists or removed from them;
    /// see CertificateStore::tell_found_changes().
    void tell_found_certificates(DateTime now);
    /// Sets the worker that checks passwords; it must end before this object and the server.
    void check_passwords_on(server::Worker& worker) { users_.passwords().set_worker(&worker); }

private:
    [[nodiscard]] Users prepare(UserConfig users) const;

    UserConfig config_;
    bool trusts_all_clients_;
    bool has_client_folders_;
    crypto::InsecureAcceptAnyCertificate accept_all_;
    crypto::CertificateStore client_store_;
    crypto::StoreValidator client_validator_;
    StorageFolder user_files_;
    crypto::CertificateStore user_store_;
    crypto::StoreValidator user_validator_;
    server::UserDirectory users_;
};

} // namespace busbar::product
