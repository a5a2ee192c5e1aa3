#pragma once

#include <busbar/server/config_check.hpp>

namespace busbar::server::detail {

/// Writes one warning for each endpoint with a policy that Part 7 no longer recommends.
void warn_of_deprecated_policies(const ServerConfig& config, LogSink& log);

} // namespace busbar::server::detail
