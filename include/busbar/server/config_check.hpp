#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/server/server.hpp>

namespace busbar::server {

/// Whether a server can be what `config` says. Bad_ConfigurationError with the contradiction in
/// words; Server::create says the same to the log.
[[nodiscard]] BUSBAR_API Checked<void> check_config(const ServerConfig& config,
                                                    const ServerEnvironment& environment);

} // namespace busbar::server
