#pragma once

#include <string>
#include <vector>

#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::server::detail {

/// Returns the policy that encrypts passwords and issued tokens on this endpoint.
[[nodiscard]] const crypto::SecurityPolicy& password_policy(const EndpointConfig& endpoint);
/// Returns the policy that users with certificates sign with on this endpoint.
[[nodiscard]] const crypto::SecurityPolicy& certificate_policy(const EndpointConfig& endpoint);

/// Returns whether the endpoint and the present users allow tokens of this kind. `users` may be
/// null.
[[nodiscard]] bool accepts(const EndpointConfig& endpoint, UserStore* users, UserTokenType type);

/// Returns the policyId of the endpoint's policy for this kind of token. One id means the same
/// policy at every endpoint (Part 4, 7.41).
[[nodiscard]] std::string policy_id(const EndpointConfig& endpoint, UserTokenType type);

/// Returns the kinds of user that the endpoint accepts (Part 4, 7.41).
[[nodiscard]] std::vector<UserTokenPolicy>
token_policies(const ServerConfig& config, const EndpointConfig& endpoint, UserStore* users);

} // namespace busbar::server::detail
