#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <busbar/administration/authorities.hpp>
#include <busbar/administration/configured_users.hpp>
#include <busbar/administration/file_system.hpp>
#include <busbar/administration/file_transfer.hpp>
#include <busbar/administration/managed_certificates.hpp>
#include <busbar/administration/role_list.hpp>
#include <busbar/administration/setting_list.hpp>
#include <busbar/administration/user_list.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/administration/status_fact.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/named_fields.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

namespace busbar::administration {

/// An administrator's request to start the server again (Part 5, 9.4).
struct RestartWish {
    /// The reason for clients; not empty.
    std::string reason;
    /// Time between the announcement and the end of connections; at most a day.
    std::chrono::seconds delay{0};
    /// EstimatedReturnTime; may be null.
    DateTime return_time{};
};

/// The parts of an Administration. All must outlive it.
struct AdministrationParts {
    [[no_unique_address]] NamedFields named_fields{};

    /// Required: the server's own wall clock.
    const WallClock* wall_clock{nullptr};
    LogSink* log{nullptr};
    /// RoleSet (Part 18, 4): the same object as the server's ServerEnvironment::roles. If null, the
    /// server has the well-known roles and no way to change them.
    RoleList* roles{nullptr};
    /// UserManagement (Part 18, 5), which is a part of ServerConfiguration: requires
    /// `certificates`. If null, users are not managed.
    UserList* users{nullptr};
    /// ServerConfiguration (Part 12, 7.10). If null, certificates are not managed.
    const ManagedCertificates* certificates{nullptr};
    /// The source of hashes of passwords, keys and names that cannot be guessed; required with
    /// `users`, `certificates` or `file_transfers`.
    crypto::Random* random{nullptr};
    /// The worker that hashes passwords and generates keys; it must end before the Administration.
    /// If null, the server's thread does that, and everything else waits meanwhile.
    server::Worker* worker{nullptr};
    /// RequestServerStateChange (Part 5, 9.4): ends the serving program. Called on the server's
    /// thread, when its server has shut down, or has begun to after a reset. If empty, clients
    /// cannot stop it.
    std::function<void()> stop{};
    /// Called instead of `stop` for a shutdown that is not a reset: the program goes on without its
    /// server, which has closed all connections before the call, in a callback of the server, and
    /// is Failed from then on, so that administrators can look and request a restart. If empty,
    /// `stop` is called.
    std::function<void(const std::string& reason)> shut_down{};
    /// Returns whether a client may set the server to Running without a restart; the problem is
    /// sent to the client. If empty, it may.
    std::function<Configured<void>()> may_run{};
    /// Likewise for a restart: the serving program ends and starts again. If empty, clients cannot
    /// request one, and a reset calls `stop`.
    std::function<void()> restart{};
    /// Used instead of `restart` by a program that replaces this server by another one (see
    /// net::ServerLoop::hand_over): the shutdown has not begun when this is called, in a callback
    /// of the server, and if it does not begin the server continues.
    std::function<void(const RestartWish& wish)> replace{};
    /// Returns a check whether `replace` would work, before a client is told that it will. The
    /// check may take long and is called on `worker`, like the work of TransferOwner::preparation;
    /// its problem goes to the log, its status to the client. If empty, it would.
    std::function<std::function<Configured<void>()>()> may_replace{};
    /// ResetToServerDefaults (Part 12, 7.10.13), requires `certificates` and `stop`: discards all
    /// changes of administrators, completely or not at all, before `restart` is called, or `stop`
    /// if there is no `restart`. Called on the server's thread; the problem is for the log. If
    /// empty, the Method does not exist.
    std::function<Configured<void>()> reset{};
    /// InApplicationSetup of ServerConfiguration (Part 12, 7.10.3); if empty, the property does not
    /// exist.
    std::function<bool()> is_in_setup{};
    /// Called before each Method of roles, users and certificates, for a user whose right may end
    /// before the session does: false answers Bad_UserAccessDenied. If empty, only roles decide.
    std::function<bool(const server::UserIdentity& user)> may_administer{};
    /// Called before each change of users, passwords and roles: the problem goes to the log, its
    /// status to the client. If empty, they may be changed.
    std::function<Configured<void>()> may_change_users{};
    /// Settings as Variables below the Object "Settings". Null for none; otherwise the owner is
    /// needed as well, whose functions are called on the server's thread while it may change the
    /// server.
    SettingList* settings{nullptr};
    SettingOwner* setting_owner{nullptr};
    /// The storages that clients see as files, each with a unique name; they are read when this is
    /// attached, whenever a client creates, moves or removes a file, and in refresh_files().
    std::vector<FileSystem> file_systems{};
    /// Files that the program creates for clients or takes from them, each with a unique name;
    /// requires `random`.
    std::vector<TemporaryFileTransfer> file_transfers{};
    /// The state of the program, as Properties of the Object "Status", for the roles Operator,
    /// Supervisor, Engineer, ConfigureAdmin and SecurityAdmin (W588, 8-1,
    /// "Service status").
    std::vector<StatusFact> status{};
    Authorities authorities{Authorities::Standard};
    /// Called on the server's thread after users or roles have changed. May be empty.
    std::function<void()> changed{};
};

/// Administers a running server by the means of the standard: nodes below the Server object and the
/// functions of their Methods. Nodes whose part is missing are absent from the address space.
///
/// Used on the server's thread. Outlives the server.
class BUSBAR_API Administration {
public:
    explicit Administration(const AdministrationParts& parts);
    Administration(const Administration&) = delete;
    Administration& operator=(const Administration&) = delete;
    ~Administration();

    /// Adds the nodes to the server and binds them; called once, before clients connect. Nodes that
    /// need a larger namespace 0 than this build has are left out, and the log says so. The problem
    /// concerns existing nodes, parts that do not fit together, or a server without a Waker, which
    /// is needed since many Methods end later than their call.
    [[nodiscard]] Configured<void> attach(server::Server& server);
    /// Files of `file_systems` were created or removed by code other than a client: clients see the
    /// changes soon. Called from any thread, after attach().
    void refresh_files();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::administration
