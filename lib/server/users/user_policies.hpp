#pragma once

#include <string>
#include <vector>

#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::server::detail {

/// What passwords and issued tokens are encrypted with on this endpoint.
[[nodiscard]] const crypto::SecurityPolicy& password_policy(const EndpointConfig& endpoint);
/// What users with certificates sign with on this endpoint.
[[nodiscard]] const crypto::SecurityPolicy& certificate_policy(const EndpointConfig& endpoint);

/// Whether the endpoint and the users that there are let tokens of this kind in. `users` may be
/// null.
[[nodiscard]] bool accepts(const EndpointConfig& endpoint, UserStore* users, UserTokenType type);

/// The policyId of the endpoint's policy for that kind of token. One id stands for the same policy
/// at every endpoint (Part 4, 7.41).
[[nodiscard]] std::string policy_id(const EndpointConfig& endpoint, UserTokenType type);

/// The kinds of user that the endpoint accepts (Part 4, 7.41).
[[nodiscard]] std::vector<UserTokenPolicy>
token_policies(const ServerConfig& config, const EndpointConfig& endpoint, UserStore* users);

} // namespace busbar::server::detail
