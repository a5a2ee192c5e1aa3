#include "administered.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/server/running_server.hpp>
#include <busbar/types/ids.hpp>

#include "identity.hpp"
#include "product/configuration/config.hpp"
#include "product/configuration/setting_keys.hpp"
#include "product/configuration/toml_reader.hpp"
#include "product/store/received_program.hpp"

namespace busbar::product {

namespace {

std::vector<NodeId> nodes_named(const std::vector<std::string>& roles)
{
    static constexpr std::array<std::pair<std::string_view, std::uint32_t>, 6> known{
        {{"Observer", id::WellKnownRole_Observer},
         {"Operator", id::WellKnownRole_Operator},
         {"Engineer", id::WellKnownRole_Engineer},
         {"Supervisor", id::WellKnownRole_Supervisor},
         {"ConfigureAdmin", id::WellKnownRole_ConfigureAdmin},
         {"SecurityAdmin", id::WellKnownRole_SecurityAdmin}}};
    std::vector<NodeId> nodes;
    for (const auto& [name, node] : known) {
        if (std::find(roles.begin(), roles.end(), name) != roles.end()) {
            nodes.emplace_back(std::uint16_t{0}, node);
        }
    }
    return nodes;
}

/// Tells whether a role administers the server (Part 3, 4.9.2).
bool is_administrative(const std::string& role)
{
    return role == "SecurityAdmin" || role == "ConfigureAdmin";
}

} // namespace

bool manages_certificates(const ControllerConfig& config)
{
    return config.server.identity.has_value() && !config.certificates.trusts_all_clients;
}

Administered::Administered(const ControllerConfig& config, Storage& files, const WallClock& clock,
                           LogSink& lines)
    : clock_{clock}, audit_{lines}, files_{files}, roles_{files_, roles_file, {}, &configured_},
      file_systems_{config.files}
{
    expect(roles_.load());
}

bool Administered::is_administrator(const administration::User& user) const
{
    return std::find(user.roles.begin(), user.roles.end(), "SecurityAdmin") != user.roles.end() ||
           roles_.is_administrator(user.name);
}

void Administered::show_accounts()
{
    const UserConfig& config = admission_->user_config();
    std::vector<administration::ConfiguredUser> users;
    for (const Account& account : config.accounts) {
        users.push_back({.name = account.name, .roles = account.roles});
    }
    if (setup_->is_active()) {
        users.push_back({.name = Setup::user_name,
                         .roles = {"SecurityAdmin", "ConfigureAdmin"},
                         .description = "of the setup, until there is an administrator",
                         .is_temporary = true});
    }
    std::vector<std::string> token_roles;
    if (config.tokens) {
        for (const auto& [role, access] : config.tokens->roles) {
            token_roles.push_back(role);
        }
    }
    configured_.replace(std::move(users), std::move(token_roles));
}

void Administered::add_users(Admission& admission, ControllerConfig& config)
{
    admission_ = &admission;
    setup_.emplace(files_, admission.clients(), admission.passwords());
    show_accounts();
    users_.emplace(
        files_, users_file, config.users.password_rules, admission.passwords(),
        [this](const administration::User& user) { return is_administrator(user); }, &configured_);
    expect(users_->load());
    keep_lists();
    if (config.users.has_setup && !users_->has_administrator()) {
        if (!manages_certificates(config)) {
            throw ConfigError{"[users]: setup",
                              "requires an [[endpoint]] with a policy other than None, and clients "
                              "that are trusted one by one: remove trust_all_clients of "
                              "[certificates]"};
        }
        waits_for_port_ = !config.machine.is_used;
        if (!waits_for_port_) { // otherwise no client could use the code to log in
            new_code_ = setup_->begin(random_, config.users.password_rules.cost);
            has_setup_ = true;
            show_accounts();
        }
    }
    offer_logins(config.server.endpoints);
}

void Administered::offer_logins(std::vector<server::EndpointConfig>& endpoints) const
{
    if (users_->users().empty() && !setup_->is_active() && !waits_for_port_) {
        return;
    }
    for (server::EndpointConfig& endpoint : endpoints) {
        endpoint.allows_user_name = true;
        // Any client may connect during a setup.
        endpoint.allows_anonymous = endpoint.allows_anonymous && !setup_->is_active();
    }
}

void Administered::end_setup(server::Server& server)
{
    if (!has_setup_ || !users_->has_administrator()) {
        return;
    }
    setup_->end();
    const server::RunningServer running{server};
    static_cast<void>(running.end_sessions(
        [](const server::UserIdentity& user) { return user.name == Setup::user_name; }));
    running.trust_changed();
    show_accounts();
    has_setup_ = false; // without memory the next change of a user does what is left
    audit_.write(LogLevel::Info, "controller", "there is an administrator: the setup is over");
}

void Administered::read_users()
{
    show_accounts();
    expect(users_->load());
}

Configured<void> Administered::reset()
{
    // Whoever set the first account's password at the machine keeps it. The files of the machine
    // that were taken over stay, too: without them it would not start if they became bad since.
    static constexpr std::array<std::string_view, 8> names{users_file,
                                                           roles_file,
                                                           Settings::file_name,
                                                           ReceivedProgram::file_name,
                                                           "setup.code",
                                                           "taken-over/settings",
                                                           "taken-over/users.json",
                                                           "taken-over/roles.json"};
    static constexpr std::array<std::string_view, 14> folders{
        "own/certs",         "own/private",         "own/crl",           "own/replaced",
        "trusted/certs",     "trusted/crl",         "issuers/certs",     "issuers/crl",
        "rejected/certs",    "users/trusted/certs", "users/trusted/crl", "users/issuers/certs",
        "users/issuers/crl", "users/rejected/certs"};
    return administration::remove_files(files_, names, folders);
}

void Administered::keep_lists()
{
    for (const char* const file : {users_file, roles_file}) {
        if (const auto kept = copies_.keep_copy(file); !kept) {
            audit_.write(LogLevel::Warning, "controller",
                         "no copy can be made of " + std::string{file} +
                             ", to be used if it is damaged: " + text(kept.error()));
        }
    }
}

void Administered::attach(const ToAdminister& what)
{
    administration::AdministrationParts parts{.wall_clock = &clock_,
                                              .log = &audit_,
                                              .roles = &roles_,
                                              .stop = what.stop,
                                              .shut_down = what.shut_down,
                                              .may_run = what.may_run,
                                              .restart = what.start_over,
                                              .replace = what.restart,
                                              .may_replace = what.may_restart};
    parts.authorities = what.config.users.authorities;
    parts.file_systems = file_systems_.all();
    parts.file_systems.insert(parts.file_systems.end(), what.file_systems.begin(),
                              what.file_systems.end());
    parts.file_transfers = what.file_transfers;
    parts.status = what.status;
    parts.random = &random_;
    parts.changed = [this] { keep_lists(); };
    parts.worker = &what.worker;
    parts.settings = &what.settings.list();
    parts.setting_owner = &what.settings;
    if (manages_certificates(what.config)) {
        certificates_.files = &files_;
        certificates_.applications = &what.admission.client_store();
        certificates_.users = what.admission.user_store();
        certificates_.users_folder = "users";
        certificates_.configured = [&config = what.config] { return configured_subject(config); };
        certificates_.may_replace_own = what.may_replace_own;
        certificates_.key_bits = what.config.certificates.key_bits;
        certificates_.renewed = [&config = what.config,
                                 renewed = what.renewed](const crypto::OwnCertificate& own) {
            config.server.identity = channel::ApplicationIdentity{own.certificates, own.key};
            if (renewed) {
                renewed();
            }
        };
        parts.reset = [this] { return reset(); };
        parts.users = &*users_;
        parts.certificates = &certificates_;
        parts.is_in_setup = [this] { return setup_->is_active(); };
        // Another user with the same code is too late: that session ends soon.
        parts.may_administer = [this](const server::UserIdentity& user) {
            return user.name != Setup::user_name || !users_->has_administrator();
        };
        // The user who sets the controller up becomes its first administrator, in any mode.
        parts.may_change_users = [this, is_in_run = what.is_in_run]() -> Configured<void> {
            return is_in_run() && !setup_->is_active() ? refused_in_run("users and roles")
                                                       : Configured<void>{};
        };
        parts.changed = [this, &server = what.server, offer_changed = what.offer_changed,
                         users_changed = what.users_changed] {
            keep_lists();
            end_setup(server);
            offer_changed();
            if (users_changed) {
                users_changed();
            }
        };
    }
    expect(administration_.emplace(parts).attach(what.server));
    if (what.config.server.is_auditing) {
        audit_.attach(what.server.event_queue(), what.server.config().application_uri);
    }
}

FileSystems::FileSystems(const std::vector<FilesConfig>& files)
{
    for (const FilesConfig& each : files) {
        storage::FolderStorage& folder = folders_.emplace_back(each.folder);
        if (const auto made = folder.make_folder("", FileAccess::Owner); !made) {
            throw ConfigError{"files " + each.name + ": " + each.folder,
                              "the folder cannot be made: " + std::string{text(made.error())}};
        }
        all_.push_back({.name = each.name,
                        .storage = &folder,
                        .limits = each.limits,
                        .readers = nodes_named(each.readers),
                        .writers = nodes_named(each.writers)});
    }
}

server::UserRights ListenerRoles::limited(const server::RoleQuestion& question,
                                          server::UserRights rights) const
{
    rights = roles_.limited(question, std::move(rights));
    switch (static_cast<ListenerUse>(question.listener)) {
    case ListenerUse::DataAndAdministration:
        break;
    case ListenerUse::Data:
        std::erase_if(rights.roles, is_administrative);
        break;
    case ListenerUse::Administration:
        std::erase_if(rights.roles,
                      [](const std::string& role) { return !is_administrative(role); });
        if (rights.roles.empty()) {
            rights.access_level_mask = 0;
        }
        break;
    }
    return rights;
}

} // namespace busbar::product
