#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/server.hpp>

namespace busbar::server {

/// Whether a server can be what `config` says in `environment`: the first problem that is found, or
/// none. `where` is an endpoint ("endpoint Basic256Sha256 Sign", or "endpoint 2", counted from 1,
/// if its policy is not known), a field of the ServerConfig ("endpoint_url") or one of the
/// environment ("environment.random"). Server::create says the same.
[[nodiscard]] BUSBAR_API Configured<void> check_config(const ServerConfig& config,
                                                       const ServerEnvironment& environment);

} // namespace busbar::server
