#pragma once

#include <span>
#include <vector>

#include <busbar/client/connection.hpp>

namespace busbar::client::detail {

[[nodiscard]] std::vector<std::byte> join(std::span<const std::byte> a,
                                          std::span<const std::byte> b);

[[nodiscard]] UserTokenType type_of(const UserIdentity& identity);

/// Returns a proof that we have `key`, over the server's certificate and last nonce (Part 4,
/// 5.7.3.2).
[[nodiscard]] Result<SignatureData> sign(const crypto::SecurityPolicy& policy,
                                         const crypto::PrivateKey& key,
                                         const crypto::Certificate& server,
                                         const ByteString& server_nonce);

/// Returns the policy for secrets and signatures of a token: that of the token policy or, if it
/// names none, of the channel (Part 4, 7.42). Null if it is unknown, or deprecated and different
/// from the channel's: a server cannot make us use a policy that the configuration does not name.
/// An anonymous `identity` has no secret: for it the token policy's is ignored.
[[nodiscard]] const crypto::SecurityPolicy* token_security(const UserTokenPolicy& policy,
                                                           const crypto::SecurityPolicy& channel,
                                                           const UserIdentity& identity);

/// Returns the token policy that protects `identity` best over such a channel; null if there is
/// none. No secret is sent in clear text: it is encrypted with the token, or by the channel.
[[nodiscard]] const UserTokenPolicy* find_token_policy(const Array<UserTokenPolicy>& policies,
                                                       const channel::SecuritySetting& security,
                                                       const UserIdentity& identity);

struct UserToken {
    ExtensionObject token;
    /// For a user certificate; null for others.
    SignatureData signature;
};

/// Part 4, 7.40: creates the token. A secret is encrypted for a server certificate that has passed
/// the validator, or not sent: Bad_SecurityPolicyRejected, or the validator's status.
[[nodiscard]] Result<UserToken> make_user_token(const ConnectionConfig& config,
                                                const channel::ChannelEnvironment& environment,
                                                const UserTokenPolicy& policy,
                                                const ByteString& server_nonce);

} // namespace busbar::client::detail
