#pragma once

#include <functional>

#include <busbar/core/log.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"

namespace busbar::administration::detail {

/// RequestServerStateChange of the Server object (Part 5, 9.4): Shutdown, and Running for a server
/// that is. It knows of no other state, and does not start itself again.
class ServerControl {
public:
    /// `stop` ends what serves, see AdministrationParts.
    ServerControl(server::Server& server, NodeTable& table, LogSink& log,
                  const std::function<void()>& stop)
        : server_{server}, table_{table}, log_{log}, stop_{stop}
    {
    }

    /// The problem says what is missing in namespace 0.
    [[nodiscard]] Configured<void> attach();

private:
    void request(server::MethodCall call);

    server::Server& server_;
    NodeTable& table_;
    LogSink& log_;
    const std::function<void()>& stop_;
};

} // namespace busbar::administration::detail
