#pragma once

#include <busbar/server/config_check.hpp>

namespace busbar::server::detail {

/// One warning for each endpoint that was given a policy which Part 7 no longer recommends.
void warn_of_deprecated_policies(const ServerConfig& config, LogSink& log);

} // namespace busbar::server::detail
