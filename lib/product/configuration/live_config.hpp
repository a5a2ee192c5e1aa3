#pragma once

#include <string>

#include <busbar/core/log.hpp>
#include <busbar/server/server.hpp>

#include "config.hpp"
#include "product/access/administered.hpp"
#include "product/access/admission.hpp"
#include "settings.hpp"

namespace busbar::product {

/// Applies a configuration to a running server as far as possible: its name, the endpoints, whether
/// they offer anonymous users, and the limits, except those of buffers that exist already.
class LiveConfig {
public:
    /// All arguments must outlive this object. The server was created with `started`; endpoints
    /// offer the other kinds of user in that.
    LiveConfig(server::Server& server, const Administered& administered,
               const ControllerConfig& started, LogSink& log);

    /// Tells whether the server would accept it; changes nothing.
    [[nodiscard]] Configured<void> check(const ControllerConfig& config) const;
    /// Applies a configuration that check() accepted. Logs steps that fail nevertheless.
    void apply(const ControllerConfig& config) const;
    /// Does the same if the endpoints would offer other kinds of user: a change that is none has no
    /// audit event.
    void apply_offer(const ControllerConfig& config) const;

private:
    [[nodiscard]] server::ServerConfig next(const ControllerConfig& config) const;

    server::Server& server_;
    const Administered& administered_;
    const ControllerConfig& started_;
    LogSink& log_;
};

/// Reads everything again that may change while the controller runs: the users and the settings in
/// the file at `path`, which is empty for the built-in one, and the trust lists. Returns a text for
/// the log. A ConfigError changes nothing.
[[nodiscard]] std::string reload(const std::string& path, Settings& settings, Admission& admission,
                                 DateTime now);

} // namespace busbar::product
