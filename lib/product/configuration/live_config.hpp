#pragma once

#include <busbar/core/log.hpp>
#include <busbar/server/server.hpp>

#include "config.hpp"
#include "product/access/administered.hpp"
#include "settings.hpp"

namespace busbar::product {

/// Puts of a configuration in force in a server that runs what can be: its name, the endpoints,
/// whether they offer anonymous users, and the limits, but those of buffers that connections and
/// the server have already.
class LiveConfig {
public:
    /// All must outlive it. `started` is what the server was made with, whose other users are those
    /// that endpoints offer.
    LiveConfig(server::Server& server, const Administered& administered,
               const ControllerConfig& started, LogSink& log);

    /// Whether the server would take it; changes nothing.
    [[nodiscard]] Configured<void> check(const ControllerConfig& config) const;
    /// One that check() found right. What fails all the same goes to the log.
    void apply(const ControllerConfig& config) const;

private:
    [[nodiscard]] server::ServerConfig next(const ControllerConfig& config) const;

    server::Server& server_;
    const Administered& administered_;
    const ControllerConfig& started_;
    LogSink& log_;
};

} // namespace busbar::product
