#pragma once

#include <busbar/channel/channel_types.hpp>
#include <busbar/client/client.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::client {

/// Checks whether a Client can do what `config` says in `environment`, whatever its server is like:
/// returns the first problem, or none. `where` is a field of the ClientConfig ("endpoint_url",
/// "security.policies") or of the environment ("environment.validator"). A Client reports the same
/// to its log and does not connect; Client::last_error() has the status.
[[nodiscard]] BUSBAR_API Configured<void>
check_config(const ClientConfig& config, const channel::ChannelEnvironment& environment);

} // namespace busbar::client
