#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/server.hpp>

namespace busbar::server {

/// Checks whether a server can be created from `config` in `environment`: returns the first
/// problem, or none. `where` is an endpoint ("endpoint Basic256Sha256 Sign", or "endpoint 2",
/// counted from 1, if its policy is unknown), a field of the ServerConfig ("endpoint_url") or one
/// of the environment ("environment.random"). Server::create returns the same.
[[nodiscard]] BUSBAR_API Configured<void> check_config(const ServerConfig& config,
                                                       const ServerEnvironment& environment);

} // namespace busbar::server
