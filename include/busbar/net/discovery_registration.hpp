#pragma once

#include <string>
#include <vector>

#include <busbar/client/registration.hpp>
#include <busbar/core/api.hpp>
#include <busbar/server/server_config.hpp>

namespace busbar::net {

/// A discovery server and the registration that it gets; see ServerLoop::register_with.
struct DiscoveryRegistrationConfig {
    /// Created by client::registration_client().
    client::ClientConfig client;
    client::RegistrationSettings settings;
};

/// Returns the registration of a server with this configuration, which clients reach at
/// `discovery_urls`.
[[nodiscard]] BUSBAR_API client::RegistrationSettings
registration_of(const server::ServerConfig& config, const std::vector<std::string>& discovery_urls);

} // namespace busbar::net
