#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include <busbar/administration/administration.hpp>
#include <busbar/administration/audit_log.hpp>
#include <busbar/administration/file_system.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "admission.hpp"
#include "product/configuration/config.hpp"
#include "product/configuration/settings.hpp"
#include "product/store/taken_over.hpp"
#include "setup.hpp"

namespace busbar::product {

/// Limits the roles that another mapper gives to the use of the listener that the client connected
/// to (ListenerUse): one for data admits no administrators, one for administration admits only
/// these.
class ListenerRoles final : public server::RoleMapper {
public:
    /// `roles` must outlive this object.
    explicit ListenerRoles(const server::RoleMapper& roles) : roles_{roles} {}

    [[nodiscard]] server::UserRights roles_of(const server::RoleQuestion& question) const override
    {
        return roles_.roles_of(question);
    }
    [[nodiscard]] server::UserRights limited(const server::RoleQuestion& question,
                                             server::UserRights rights) const override;

private:
    const server::RoleMapper& roles_;
};

/// The folders whose files clients can see.
class FileSystems {
public:
    /// Creates missing folders. Throws ConfigError.
    explicit FileSystems(const std::vector<FilesConfig>& files);

    /// The FileSystems refer to this object.
    [[nodiscard]] const std::vector<administration::FileSystem>& all() const { return all_; }

private:
    std::deque<storage::FolderStorage> folders_;
    std::vector<administration::FileSystem> all_;
};

/// Tells whether certificates and users are managed online, which requires that certificates decide
/// about clients.
[[nodiscard]] bool manages_certificates(const ControllerConfig& config);

/// The objects that an Administered uses. All must outlive it, except the worker, which must end
/// before it.
struct ToAdminister {
    server::Server& server;
    Admission& admission;
    /// Updated when the certificate changes.
    ControllerConfig& config;
    Settings& settings;
    server::Worker& worker;
    /// Ends the program.
    std::function<void()> stop;
    /// Starts the program again after a reset.
    std::function<void()> start_over;
    /// Goes on without the server; empty: the program ends.
    std::function<void(const std::string& reason)> shut_down;
    /// Tells whether the server may continue without a restart, or why not.
    std::function<Configured<void>()> may_run;
    /// Replaces the server by a new one soon.
    std::function<void(const administration::RestartWish& wish)> restart;
    /// Returns a check whether a restart would work, for the worker.
    std::function<std::function<Configured<void>()>()> may_restart;
    /// Tells whether the certificate may be replaced now, or why not.
    std::function<Configured<void>()> may_replace_own;
    /// Tells whether a machine is in RUN, where users and roles cannot change (W588, 3-2-6).
    std::function<bool()> is_in_run;
    /// Called on the server's thread after users or roles have changed. May be empty.
    std::function<void()> users_changed;
    /// Called on the server's thread when the kinds of user that may log in have changed.
    std::function<void()> offer_changed;
    /// Called on the server's thread when `config` got another certificate. May be empty.
    std::function<void()> renewed;
    /// In addition to those of the configuration.
    std::vector<administration::FileSystem> file_systems;
    std::vector<administration::TemporaryFileTransfer> file_transfers;
    std::vector<administration::StatusFact> status{};
};

/// Everything that administrators change while the controller runs, kept in the folder of
/// certificates.
class Administered {
public:
    static constexpr const char* users_file = "users.json";
    static constexpr const char* roles_file = "roles.json";

    /// Throws a ConfigError if a list in `files`, the folder of certificates, cannot be read. All
    /// arguments must outlive this object.
    Administered(const ControllerConfig& config, Storage& files, const WallClock& clock,
                 LogSink& lines);

    /// Returns the server's log.
    [[nodiscard]] LogSink& log() { return audit_; }
    [[nodiscard]] administration::AuditLog& audit() { return audit_; }
    [[nodiscard]] const server::RoleMapper& roles() const { return listener_roles_; }
    /// Adds the users that were added online to those of the file, and lets `config` offer them.
    /// Called once, before the server is created. Throws ConfigError. `admission` must outlive this
    /// object.
    void add_users(Admission& admission, ControllerConfig& config);
    /// Makes endpoints offer passwords if a user of the list, or of the setup, has one, and keeps
    /// anonymous users out during a setup.
    void offer_logins(std::vector<server::EndpointConfig>& endpoints) const;
    /// Decides about clients, also during a setup.
    [[nodiscard]] crypto::CertificateValidator& clients() { return *setup_; }
    /// The one-time code of the setup, if this is the first start of a controller with a setup.
    [[nodiscard]] const std::optional<crypto::Secret>& new_code() const { return new_code_; }
    /// Keeps new_code() for further starts; otherwise it ends with this object.
    void code_is_shown() { setup_->code_is_shown(); }
    /// Returns true while there is no administrator but the one of the setup.
    [[nodiscard]] bool is_in_setup() const { return setup_ && setup_->is_active(); }
    /// Returns true if there would be a setup, but there is no port for it.
    [[nodiscard]] bool is_waiting_for_port() const { return waits_for_port_; }
    /// The place of the file with the code's hash, for people.
    [[nodiscard]] std::string code_place() const { return files_.place(Setup::code_file); }
    /// Reads the users again, after `admission` has read its file again. Throws ConfigError.
    void read_users();
    /// Connects all this to the server; called once, before clients connect. Throws ConfigError.
    void attach(const ToAdminister& what);
    /// See Administration; call it after attach(). Thread-safe.
    void refresh_files() { administration_->refresh_files(); }

private:
    void end_setup(server::Server& server);
    /// Shows administrators the accounts that `admission_` and the setup have.
    void show_accounts();
    /// Copies the lists, for a start at which they are damaged.
    void keep_lists();
    /// Deletes all that administrators changed, and all certificates.
    [[nodiscard]] Configured<void> reset();
    /// Thread-safe.
    [[nodiscard]] bool is_administrator(const administration::User& user) const;

    const WallClock& clock_;
    administration::AuditLog audit_;
    Storage& files_;
    crypto::SystemRandom random_;
    Admission* admission_{nullptr};
    std::optional<Setup> setup_;
    std::optional<crypto::Secret> new_code_;
    administration::ConfiguredUsers configured_;
    administration::RoleList roles_;
    ListenerRoles listener_roles_{roles_};
    std::optional<administration::UserList> users_;
    TakenOverFiles copies_{files_};
    bool waits_for_port_{false};
    bool has_setup_{false}; // of which end_setup() has not done all
    administration::ManagedCertificates certificates_;
    FileSystems file_systems_;
    std::optional<administration::Administration> administration_;
};

} // namespace busbar::product
