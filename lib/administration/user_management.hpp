#pragma once

#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include <busbar/administration/user_list.hpp>
#include <busbar/core/record.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

#include "node_table.hpp"
#include "permissions.hpp"

namespace busbar::administration::detail {

/// The UserManagement object (Part 18, 5) over a UserList.
class UserManagement {
public:
    struct Needs {
        server::Server& server;
        UserList& users;
        NodeTable& table;
        /// Raised when users change.
        NodeTable::Signal& changed;
        LogSink& log;
        crypto::Random& random;
        /// Hashes passwords, which takes tens of milliseconds; if null, the server's thread does.
        server::Worker* worker;
        /// See AdministrationParts::may_change_users.
        const std::function<Configured<void>()>& may_change;
    };

    explicit UserManagement(const Needs& needs)
        : server_{needs.server}, space_{needs.server.address_space()}, users_{needs.users},
          table_{needs.table}, changed_{needs.changed}, log_{needs.log}, random_{needs.random},
          worker_{needs.worker}, may_change_{needs.may_change}
    {
    }

    /// Connects the nodes, after ServerConfiguration has added them. The problem names what is
    /// missing in namespace 0.
    [[nodiscard]] Configured<void> attach();

private:
    /// Prepares the change that a Method makes to the list, without changing anything.
    using Change = std::function<Checked<UserList::Prepared>(const server::MethodCall&)>;
    struct Job {
        server::MethodCall call;
        Holder holder;
        Change change;
        /// Name of the calling user.
        std::string user;
        /// True if the job tries a password, as a login does.
        bool tries_password;
        /// Ends the sessions of a user whose rights are gone (Part 18, 5.2.6 and 5.2.7); may be
        /// null.
        std::unique_ptr<NodeTable::Task> end_sessions{};
        /// The password that is tried, once the job runs.
        std::optional<server::PasswordTrial> trial{};
    };

    void bind_values();
    void add(server::MethodCall call);
    void modify(server::MethodCall call);
    void remove(server::MethodCall call);
    void change_password(server::MethodCall call);
    /// Prepares the change where passwords are hashed, then makes it on the server's thread if the
    /// client still waits and its user still has the right, and answers. Runs one job at a time, so
    /// that logins, which use the same worker, wait for at most one; users take turns.
    void run(server::MethodCall call, Change change, const std::string& sessions_end_of = {},
             bool tries_password = false);
    /// Makes room for a job in the queue. If the queue is full, a job of the user with the most is
    /// refused, provided that it is another user with more jobs.
    [[nodiscard]] bool make_room(const Holder& holder);
    [[nodiscard]] std::shared_ptr<Job> take_next();
    void start_next();
    void start(const std::shared_ptr<Job>& job);
    /// False if the call was refused instead.
    [[nodiscard]] bool may_start(Job& job);
    /// Good if the client still waits and its user still has the right.
    [[nodiscard]] StatusCode check_wanted(const Job& job) const;
    void finish(Job& job, const Checked<UserList::Prepared>& prepared);

    server::Server& server_;
    model::AddressSpace& space_;
    UserList& users_;
    NodeTable& table_;
    NodeTable::Signal& changed_;
    LogSink& log_;
    crypto::Random& random_;
    server::Worker* worker_;
    const std::function<Configured<void>()>& may_change_;
    std::list<std::shared_ptr<Job>> jobs_; // waiting jobs
    /// Not expired while the worker has a job, however that ends.
    std::weak_ptr<const void> busy_;
    std::string last_user_;
};

} // namespace busbar::administration::detail
