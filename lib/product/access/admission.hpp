#pragma once

#include <busbar/core/storage_folder.hpp>
#include <busbar/crypto/store_validator.hpp>
#include <busbar/server/user_directory.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// Who is let in: the trust lists of clients and, apart from them, of users; the users themselves.
class Admission {
public:
    /// Makes the folders that are missing in `files`, the folder of certificates. Throws
    /// ConfigError. `files` and `log` must outlive it.
    Admission(const ControllerConfig& config, Storage& files, LogSink& log);

    [[nodiscard]] crypto::CertificateValidator& clients();
    [[nodiscard]] server::UserStore& users() { return users_; }
    /// The users that are let in now.
    [[nodiscard]] const UserConfig& user_config() const { return config_; }
    [[nodiscard]] server::PasswordUsers& passwords() { return users_.passwords(); }
    [[nodiscard]] crypto::CertificateStore& client_store() { return client_store_; }
    /// Null if no user has a certificate.
    [[nodiscard]] crypto::CertificateStore* user_store()
    {
        return config_.certified ? &user_store_ : nullptr;
    }
    /// From now on; nothing: endpoints let in no anonymous users. Their sessions are the caller's.
    void let_anonymous_in(std::optional<AccountAccess> access);
    /// Throws a ConfigError that begins with `file` if kinds of user came or went, but anonymous
    /// ones: endpoints offer those since the start.
    void check_users(const UserConfig& users, const std::string& file) const;
    /// Lets in whom `users` names from now on, and nobody else; after check_users().
    void replace_users(const UserConfig& users);
    /// Reads the trust lists again, which happens anyway when files change, and tells the log of
    /// what was found; how many there are.
    [[nodiscard]] std::string read_certificates(DateTime now);
    /// Tells the log of certificates that came into the folders of the trust lists or went from
    /// there; see CertificateStore::tell_found_changes().
    void tell_found_certificates(DateTime now);
    /// Where passwords are checked from now on; it is to end before this and the server.
    void check_passwords_on(server::Worker& worker) { users_.passwords().set_worker(&worker); }

private:
    void add_users();

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
