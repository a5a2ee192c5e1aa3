#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <busbar/administration/administration.hpp>
#include <busbar/administration/audit_log.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/random.hpp>

#include "admission.hpp"
#include "file_systems.hpp"
#include "listener_roles.hpp"
#include "product/configuration/config.hpp"
#include "product/configuration/settings.hpp"
#include "product/store/taken_over.hpp"
#include "setup.hpp"

namespace busbar::product {

/// Whether certificates and users are managed online: where certificates decide.
[[nodiscard]] bool manages_certificates(const ControllerConfig& config);

/// What an Administered works on; all must outlive it, but the worker, which is to end before.
struct ToAdminister {
    server::Server& server;
    Admission& admission;
    /// Is told of another certificate.
    ControllerConfig& config;
    Settings& settings;
    server::Worker& worker;
    /// Ends the program.
    std::function<void()> stop;
    /// Has the program start again after a reset.
    std::function<void()> start_over;
    /// Goes on without the server; empty: the program ends.
    std::function<void(const std::string& reason)> shut_down;
    /// Whether the server may go on without a restart, and if not, why not.
    std::function<Configured<void>()> may_run;
    /// Has another server take over, soon.
    std::function<void(const administration::RestartWish& wish)> restart;
    /// Whether that would work, and if not, why not.
    std::function<Configured<void>()> may_restart;
    /// Whether a machine is in RUN, in which users and roles stay as they are (W588, 3-2-6).
    std::function<bool()> is_in_run;
    /// Called on the server's thread after users or roles have changed. May be empty.
    std::function<void()> users_changed;
    /// Called on the server's thread when other kinds of user may log in than before.
    std::function<void()> offer_changed;
    /// Called on the server's thread when `config` was told of another certificate. May be empty.
    std::function<void()> renewed;
    /// Beside those of the configuration.
    std::vector<administration::FileSystem> file_systems;
    std::vector<administration::TemporaryFileTransfer> file_transfers;
    std::vector<administration::StatusFact> status{};
};

/// What administrators change while the controller runs, kept in the folder of certificates.
class Administered {
public:
    static constexpr const char* users_file = "users.json";
    static constexpr const char* roles_file = "roles.json";

    /// Throws a ConfigError if what is kept in `files`, the folder of certificates, cannot be read.
    /// All must outlive it.
    Administered(const ControllerConfig& config, Storage& files, const WallClock& clock,
                 LogSink& lines);

    /// The server's log.
    [[nodiscard]] LogSink& log() { return audit_; }
    [[nodiscard]] const server::RoleMapper& roles() const { return listener_roles_; }
    /// Users who were added while it ran come to those of the file, and `config` offers them. Once,
    /// before the server is made. Throws ConfigError. `admission` must outlive it.
    void add_users(Admission& admission, ControllerConfig& config);
    /// Has endpoints offer passwords if a user of the list, or of the setup, has one.
    void offer_passwords(std::vector<server::EndpointConfig>& endpoints) const;
    /// Who decides about clients, also in a setup.
    [[nodiscard]] crypto::CertificateValidator& clients() { return *setup_; }
    /// The one-time code of the setup, if this is the first start of a controller that has one.
    [[nodiscard]] const std::optional<crypto::Secret>& new_code() const { return new_code_; }
    /// Returns true while there is no administrator but the one of the setup.
    [[nodiscard]] bool is_in_setup() const { return setup_ && setup_->is_active(); }
    /// Returns true if there would be a setup, but no port by which anybody could do it.
    [[nodiscard]] bool is_waiting_for_port() const { return waits_for_port_; }
    /// Where the hash of the code lies, for people.
    [[nodiscard]] std::string code_place() const { return files_.place(Setup::code_file); }
    /// Those users again, after `admission` has read its file again. Throws ConfigError.
    void read_users();
    /// Once, before clients connect. Throws ConfigError.
    void attach(const ToAdminister& what);
    /// See Administration; after attach(). Any thread.
    void refresh_files() { administration_->refresh_files(); }

private:
    void end_setup(server::Server& server);
    /// Shows administrators the accounts that `admission_` and the setup have.
    void show_accounts();
    /// For a start at which they are damaged.
    void keep_lists();
    /// What administrators changed, and all certificates.
    [[nodiscard]] Configured<void> reset();
    /// Any thread.
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
    administration::ManagedCertificates certificates_;
    FileSystems file_systems_;
    std::optional<administration::Administration> administration_;
};

} // namespace busbar::product
