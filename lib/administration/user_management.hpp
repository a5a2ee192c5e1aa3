#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>

#include <busbar/administration/user_list.hpp>
#include <busbar/core/record.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

#include "node_table.hpp"
#include "permissions.hpp"

namespace busbar::administration::detail {

/// The UserManagement object (Part 18, 5) over a UserList.
class UserManagement {
public:
    /// Where passwords are hashed, which takes tens of milliseconds; null: the server's thread.
    UserManagement(server::Server& server, UserList& users, NodeTable& table, LogSink& log,
                   crypto::Random& random, server::Worker* worker)
        : server_{server}, space_{server.address_space()}, users_{users}, table_{table}, log_{log},
          random_{random}, worker_{worker}
    {
    }

    /// The problem says what is missing in namespace 0. After ServerConfiguration, which has it.
    [[nodiscard]] Configured<void> attach();

private:
    /// What a Method does to the list.
    using Change = std::function<Checked<void>(const server::MethodCall&)>;
    struct Job {
        std::shared_ptr<server::MethodCall> call;
        Holder holder;
        Change change;
        /// Sessions of this user, if not empty, end (Part 18, 5.2.6 and 5.2.7).
        std::string sessions_end_of;
        /// It tries a password, as a login does.
        bool tries_password;
        /// While it exists the worker is at this job, however that ends.
        std::shared_ptr<const void> busy{};
    };

    void bind_values();
    void add(server::MethodCall call);
    void modify(server::MethodCall call);
    void remove(server::MethodCall call);
    void change_password(server::MethodCall call);
    /// Does the change where passwords are hashed, then answers. One at a time, so that logins,
    /// which use the same worker, wait for one of them at most; users take turns.
    void run(server::MethodCall call, Change change, std::string sessions_end_of = {},
             bool tries_password = false);
    [[nodiscard]] Job take_next();
    void start_next();
    /// False if the call was refused instead.
    [[nodiscard]] bool may_start(Job& job);
    void finish(const Job& job, const Checked<void>& done);

    server::Server& server_;
    model::AddressSpace& space_;
    UserList& users_;
    NodeTable& table_;
    LogSink& log_;
    crypto::Random& random_;
    server::Worker* worker_;
    std::deque<Job> jobs_; // that wait
    std::weak_ptr<const void> busy_;
    std::string last_user_;
};

} // namespace busbar::administration::detail
