#pragma once

#include <functional>
#include <string>

#include <busbar/administration/user_list.hpp>
#include <busbar/core/record.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

#include "node_table.hpp"

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

    void bind_values();
    void add(server::MethodCall call);
    void modify(server::MethodCall call);
    void remove(server::MethodCall call);
    void change_password(server::MethodCall call);
    /// Does the change where passwords are hashed, then answers. Sessions of the user
    /// `sessions_end_of`, if not empty, end (Part 18, 5.2.6 and 5.2.7).
    void run(server::MethodCall call, Change change, std::string sessions_end_of = {});
    void finish(server::MethodCall& call, const Checked<void>& done, const std::string& whose);

    server::Server& server_;
    model::AddressSpace& space_;
    UserList& users_;
    NodeTable& table_;
    LogSink& log_;
    crypto::Random& random_;
    server::Worker* worker_;
};

} // namespace busbar::administration::detail
