#pragma once

#include <chrono>
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
#include <busbar/core/log.hpp>
#include <busbar/core/named_fields.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

namespace busbar::administration {

/// What an administrator asks for who wants the server to start again (Part 5, 9.4).
struct RestartWish {
    /// For clients; not empty.
    std::string reason;
    /// How long they are told before their connections are closed; a day at most.
    std::chrono::seconds delay{0};
    /// EstimatedReturnTime; may be null.
    DateTime return_time{};
};

/// What an Administration is made of. All must outlive it.
struct AdministrationParts {
    [[no_unique_address]] NamedFields named_fields{};

    /// Required: the server's own ones.
    const WallClock* wall_clock{nullptr};
    LogSink* log{nullptr};
    /// RoleSet (Part 18, 4): the one that is the server's ServerEnvironment::roles too. Null: the
    /// server has well-known roles and no way to change them.
    RoleList* roles{nullptr};
    /// UserManagement (Part 18, 5), which is a part of ServerConfiguration: not without
    /// `certificates`. Null: users are not managed.
    UserList* users{nullptr};
    /// ServerConfiguration (Part 12, 7.10). Null: certificates are not managed.
    const ManagedCertificates* certificates{nullptr};
    /// For hashes of passwords, for keys and for names that nobody guesses; required with `users`,
    /// `certificates` or `file_transfers`.
    crypto::Random* random{nullptr};
    /// Where passwords are hashed and keys are made; it is to end before the Administration. Null:
    /// the server's thread, which everybody waits for then.
    server::Worker* worker{nullptr};
    /// RequestServerStateChange (Part 5, 9.4): ends the program that serves, whose server has shut
    /// down, or begun to after a reset, when this is called, on the server's thread. Empty: clients
    /// cannot stop it.
    std::function<void()> stop{};
    /// The same for a restart: the program that serves ends and starts again. Empty: clients cannot
    /// ask for one.
    std::function<void()> restart{};
    /// Instead of `restart`, for a program that has another server take the place of this one (see
    /// net::ServerLoop::hand_over): the shutdown has not begun when this is called, in a callback
    /// of the server's, and if there is none after all the server goes on.
    std::function<void(const RestartWish& wish)> replace{};
    /// Whether `replace` would work, asked before a client is told that it will; the problem goes
    /// to the log, its status to the client. Empty: it would.
    std::function<Configured<void>()> may_replace{};
    /// ResetToServerDefaults (Part 12, 7.10.13), not without `certificates` and `stop`: forgets all
    /// that administrators changed, whole or not at all, before `stop` is called. On the server's
    /// thread; the problem is for the log. Empty: there is no such Method.
    std::function<Configured<void>()> reset{};
    /// InApplicationSetup of ServerConfiguration (Part 12, 7.10.3); empty: it does not say.
    std::function<bool()> is_in_setup{};
    /// Asked before each Method of roles, users and certificates, for a user whose right may end
    /// before the session does: false answers Bad_UserAccessDenied. Empty: nothing more than roles
    /// decides.
    std::function<bool(const server::UserIdentity& user)> may_administer{};
    /// Asked before each change of users, passwords and roles: the problem goes to the log, its
    /// status to the client. Empty: they may change.
    std::function<Configured<void>()> may_change_users{};
    /// Settings as Variables below the Object "Settings". Null: there are none; else with the
    /// owner, whose functions are called on the server's thread where it may change the server.
    SettingList* settings{nullptr};
    SettingOwner* setting_owner{nullptr};
    /// What clients see as files, each with a name of its own; they are read when this is
    /// attached, whenever a client makes, moves or removes one, and in refresh_files().
    std::vector<FileSystem> file_systems{};
    /// Files that the program makes for clients or takes from them, each with a name of its own;
    /// not without `random`.
    std::vector<TemporaryFileTransfer> file_transfers{};
    /// How the program is, as Properties of the Object "Status", for the roles Operator,
    /// Supervisor, Engineer, ConfigureAdmin and SecurityAdmin (seed 000, 8-1, "Service status").
    std::vector<StatusFact> status{};
    Authorities authorities{Authorities::Standard};
    /// Called on the server's thread after users or roles have changed. May be empty.
    std::function<void()> changed{};
};

/// What administrators do while a server runs, by the means of the standard: nodes below the Server
/// object and what is behind their Methods. What a part is missing for is absent from the address
/// space.
///
/// On the server's thread. Outlives the server.
class BUSBAR_API Administration {
public:
    explicit Administration(const AdministrationParts& parts);
    Administration(const Administration&) = delete;
    Administration& operator=(const Administration&) = delete;
    ~Administration();

    /// Adds the nodes to the server and binds them; once, before clients connect. What namespace 0
    /// of this build is too small for is left out, and the log says so. The problem is one of nodes
    /// that are there already, of parts that do not go together, or of a server without a Waker:
    /// many Methods end later than their call.
    [[nodiscard]] Configured<void> attach(server::Server& server);
    /// Somebody else than a client made or removed files of `file_systems`: clients see them as
    /// they are, soon. Any thread, from attach() on.
    void refresh_files();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::administration
