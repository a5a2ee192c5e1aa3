#include <busbar/administration/administration.hpp>

#include <deque>
#include <optional>

#include <busbar/types/ids.hpp>

#include "file_nodes.hpp"
#include "node_table.hpp"
#include "rights.hpp"
#include "role_set.hpp"
#include "server_configuration.hpp"
#include "server_control.hpp"
#include "setting_nodes.hpp"
#include "status_nodes.hpp"
#include "transfer_nodes.hpp"
#include "user_management.hpp"

namespace busbar::administration {

struct Administration::Impl {
    explicit Impl(const AdministrationParts& p)
        : parts{p}, table{*p.wall_clock, *p.log},
          changed{table.add_signal([this] {
              if (parts.changed) {
                  parts.changed();
              }
          })},
          files_changed{table.add_signal([this] {
              for (detail::FileNodes& files : file_nodes) {
                  files.refresh();
              }
          })}
    {
        table.ask_before_calls(parts.may_administer);
    }

    AdministrationParts parts;
    detail::NodeTable table;
    /// Raised when users or roles change.
    detail::NodeTable::Signal& changed;
    detail::NodeTable::Signal& files_changed;
    std::optional<detail::RoleSet> role_set;
    std::optional<detail::ServerConfiguration> server_configuration;
    std::optional<detail::UserManagement> user_management;
    std::optional<detail::ServerControl> server_control;
    std::optional<detail::ServerReset> server_reset;
    std::optional<detail::SettingNodes> setting_nodes;
    std::deque<detail::FileNodes> file_nodes;
    std::deque<detail::TransferNodes> transfer_nodes;

    [[nodiscard]] Configured<void> check() const;
    [[nodiscard]] Configured<void> check_files() const;
    [[nodiscard]] Configured<void> attach(server::Server& server);
    [[nodiscard]] Configured<void> attach_files(server::Server& server);
    [[nodiscard]] Configured<void> attach_certificates(server::Server& server);
};

Administration::Administration(const AdministrationParts& parts)
    : impl_{std::make_unique<Impl>(parts)}
{
}

Administration::~Administration() = default;

Configured<void> Administration::Impl::check() const
{
    if (parts.users != nullptr && parts.certificates == nullptr) {
        return misconfigured("users", "need certificates: ServerConfiguration manages both");
    }
    if (parts.certificates != nullptr &&
        (parts.certificates->files == nullptr || parts.certificates->applications == nullptr)) {
        return misconfigured("certificates", "have no files or no store of applications");
    }
    if (parts.reset && (parts.certificates == nullptr || !parts.stop)) {
        return misconfigured("reset", "needs certificates and stop");
    }
    if ((parts.settings != nullptr) != (parts.setting_owner != nullptr)) {
        return misconfigured("settings", "and setting_owner need each other");
    }
    if ((parts.certificates != nullptr || !parts.file_transfers.empty()) &&
        parts.random == nullptr) {
        return misconfigured("random", "is missing");
    }
    return check_files();
}

Configured<void> Administration::Impl::check_files() const
{
    for (const FileSystem& files : parts.file_systems) {
        if (files.storage == nullptr || !detail::is_file_name(files.name)) {
            return misconfigured("files \"" + files.name + "\"",
                                 "have no storage, or a name that is not a valid file name");
        }
    }
    for (const TemporaryFileTransfer& transfer : parts.file_transfers) {
        if (transfer.owner == nullptr || !detail::is_file_name(transfer.name) ||
            transfer.client_processing_timeout <= std::chrono::milliseconds{0}) {
            return misconfigured("transfer \"" + transfer.name + "\"",
                                 "has no owner, no timeout, or a name that is not a file name");
        }
    }
    return {};
}

Configured<void> Administration::Impl::attach(server::Server& server)
{
    table.set_server(server);
    if (parts.roles != nullptr) {
        role_set.emplace(server, *parts.roles, table, changed, *parts.log,
                         parts.may_change_users);
        if (auto attached = role_set->attach(); !attached) {
            return attached;
        }
    }
    if (parts.stop &&
        server.address_space().find(id::SystemStatusChangeEventType) != model::no_node) {
        server_control.emplace(detail::ServerControl::Needs{
            server, table, *parts.log, parts.worker, parts.stop, parts.shut_down, parts.may_run,
            parts.restart, parts.replace, parts.may_replace});
        if (auto attached = server_control->attach(); !attached) {
            return attached;
        }
    }
    if (parts.settings != nullptr) {
        setting_nodes.emplace(detail::SettingNodes::Needs{
            server, *parts.settings, *parts.setting_owner, table, *parts.log, *parts.wall_clock,
            parts.authorities});
        if (auto attached = setting_nodes->add_nodes(); !attached) {
            return attached;
        }
    }
    if (auto attached = attach_files(server); !attached) {
        return attached;
    }
    if (!parts.status.empty()) {
        if (auto attached =
                detail::add_status_nodes(server, table, parts.status, parts.authorities);
            !attached) {
            return attached;
        }
    }
    return parts.certificates != nullptr ? attach_certificates(server) : Configured<void>{};
}

Configured<void> Administration::Impl::attach_files(server::Server& server)
{
    for (const FileSystem& files : parts.file_systems) {
        auto& nodes = file_nodes.emplace_back(server, files, *parts.wall_clock, *parts.log);
        if (auto attached = nodes.add_nodes(); !attached) {
            return attached;
        }
    }
    for (const TemporaryFileTransfer& transfer : parts.file_transfers) {
        auto& nodes = transfer_nodes.emplace_back(
            detail::TransferNodes::Needs{server, transfer, *parts.random, *parts.wall_clock,
                                         *parts.log, table, parts.worker});
        if (auto attached = nodes.add_nodes(); !attached) {
            return attached;
        }
    }
    return {};
}

Configured<void> Administration::Impl::attach_certificates(server::Server& server)
{
    if (server.address_space().find(id::ServerConfigurationType) == model::no_node) {
        parts.log->write(LogLevel::Info, "administration",
                         "no ServerConfiguration: namespace 0 of this build is too small for it "
                         "(BUSBAR_NAMESPACE0)");
        return {};
    }
    server_configuration.emplace(server, *parts.certificates, table, *parts.wall_clock, *parts.log,
                                 parts.worker, parts.is_in_setup);
    if (auto attached = server_configuration->attach(); !attached) {
        return attached;
    }
    if (parts.reset) {
        const auto& end = parts.restart ? parts.restart : parts.stop;
        server_reset.emplace(
            detail::ServerReset::Needs{server, table, *parts.log, parts.reset, end});
        if (auto attached = server_reset->attach(); !attached) {
            return attached;
        }
    }
    if (parts.users == nullptr) {
        return {};
    }
    user_management.emplace(detail::UserManagement::Needs{
        server, *parts.users, table, changed, *parts.log, *parts.random, parts.worker,
        parts.may_change_users});
    return user_management->attach();
}

Configured<void> Administration::attach(server::Server& server)
{
    if (auto checked = impl_->check(); !checked) {
        return checked;
    }
    server.add_source(impl_->table);
    if (!impl_->table.has_way_back()) {
        return misconfigured("waker", "is missing in the server's environment: Methods that end "
                                      "later have no way back to the server's thread");
    }
    auto attached = impl_->attach(server);
    if (attached) {
        detail::give_rights(server.address_space(), impl_->parts.authorities);
    }
    return attached;
}

void Administration::refresh_files()
{
    impl_->table.raise(impl_->files_changed);
}

} // namespace busbar::administration
