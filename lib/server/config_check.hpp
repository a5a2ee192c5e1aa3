#pragma once

#include <string>

#include <busbar/server/server.hpp>

namespace busbar::server::detail {

/// Why a server cannot be what `config` says; empty if it can.
[[nodiscard]] std::string find_contradiction(const ServerConfig& config,
                                             const ServerEnvironment& environment);

} // namespace busbar::server::detail
