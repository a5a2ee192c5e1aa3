#pragma once

#include <string>

#include <busbar/server/server.hpp>

namespace busbar::server::detail {

/// Why a server cannot be what `config` says; empty if it can.
[[nodiscard]] std::string find_contradiction(const ServerConfig& config,
                                             const ServerEnvironment& environment);

/// One warning for each endpoint that was given a policy which Part 7 no longer recommends.
void warn_of_deprecated_policies(const ServerConfig& config, LogSink& log);

} // namespace busbar::server::detail
