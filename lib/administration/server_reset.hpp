#pragma once

#include <functional>

#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// Implements ResetToServerDefaults of ServerConfiguration (Part 12, 7.10.13): forgets the changes
/// of administrators and ends the server, after warning its clients.
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

    /// Connects the Method, after ServerConfiguration. The problem names what is missing in
    /// namespace 0.
    [[nodiscard]] Configured<void> attach();

private:
    void reset(server::MethodCall& call);

    Needs needs_;
};

} // namespace busbar::administration::detail
