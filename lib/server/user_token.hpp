#pragma once

#include <span>
#include <vector>

#include <busbar/core/extension_object.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/server_config.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::server::detail {

/// What passwords are encrypted with on this endpoint.
[[nodiscard]] const crypto::SecurityPolicy& password_policy(const EndpointConfig& endpoint);

/// The kinds of user that the endpoint accepts (Part 4, 7.42).
[[nodiscard]] std::vector<UserTokenPolicy> token_policies(const EndpointConfig& endpoint,
                                                          bool has_users);

/// What log_in needs besides the token.
struct LoginContext {
    const EndpointConfig& endpoint;
    /// May be null.
    UserStore* users;
    /// Decrypts passwords; may be null.
    const crypto::PrivateKey* key;
    std::span<const std::byte> server_nonce;
};

/// The user that a UserIdentityToken stands for (Part 4, 7.41); a null token is anonymous.
/// Bad_IdentityTokenInvalid for one that has not the form of its policy, Bad_IdentityTokenRejected
/// for a kind that is not accepted, and for all that a guess at a password can come to, be it that
/// it does not decrypt, Bad_UserAccessDenied.
[[nodiscard]] Result<UserIdentity> log_in(const LoginContext& context,
                                          const ExtensionObject& token);

} // namespace busbar::server::detail
