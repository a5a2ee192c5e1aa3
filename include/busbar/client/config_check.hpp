#pragma once

#include <busbar/channel/channel_types.hpp>
#include <busbar/client/client.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::client {

/// Whether a Client can do what `config` says in `environment`, whatever its server is like: the
/// first problem that is found, or none. `where` is a field of the ClientConfig ("endpoint_url",
/// "security.policies") or of the environment ("environment.validator"). A Client tells its log the
/// same and does not connect; Client::last_error() has the status.
[[nodiscard]] BUSBAR_API Configured<void>
check_config(const ClientConfig& config, const channel::ChannelEnvironment& environment);

} // namespace busbar::client
