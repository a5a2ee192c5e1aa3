#pragma once

#include <functional>

#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// ResetToServerDefaults of ServerConfiguration (Part 12, 7.10.13): forgets what administrators
/// changed and ends the server, which warns its clients.
class ServerReset {
public:
    /// See AdministrationParts.
    struct Needs {
        server::Server& server;
        NodeTable& table;
        LogSink& log;
        const std::function<Configured<void>()>& reset;
        /// Ends the program, which may start again.
        const std::function<void()>& end;
    };

    explicit ServerReset(const Needs& needs) : needs_{needs} {}

    /// After ServerConfiguration. The problem says what is missing in namespace 0.
    [[nodiscard]] Configured<void> attach();

private:
    void reset(server::MethodCall& call);

    Needs needs_;
};

} // namespace busbar::administration::detail
