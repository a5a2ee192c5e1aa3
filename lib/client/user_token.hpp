#pragma once

#include <span>
#include <vector>

#include <busbar/client/connection.hpp>

namespace busbar::client::detail {

[[nodiscard]] std::vector<std::byte> join(std::span<const std::byte> a,
                                          std::span<const std::byte> b);

[[nodiscard]] UserTokenType type_of(const UserIdentity& identity);

/// A proof that we have `key`, over the server's certificate and last nonce (Part 4, 5.7.3.2).
[[nodiscard]] Result<SignatureData> sign(const crypto::SecurityPolicy& policy,
                                         const crypto::PrivateKey& key,
                                         const crypto::Certificate& server,
                                         const ByteString& server_nonce);

/// The policy that secrets and signatures of a token are made with: that of the token policy or,
/// if it names none, of the channel (Part 4, 7.42). Null if it is unknown, or deprecated and not
/// what the channel uses: a server cannot make us use what we were not told to use. An anonymous
/// `identity` has no secret, so that whatever the token policy names is ignored.
[[nodiscard]] const crypto::SecurityPolicy* token_security(const UserTokenPolicy& policy,
                                                           const crypto::SecurityPolicy& channel,
                                                           const UserIdentity& identity);

/// The token policy that protects `identity` best over such a channel; null if there is none that
/// does. Nothing secret goes out in the clear: it is encrypted with the token, or by the channel.
[[nodiscard]] const UserTokenPolicy* find_token_policy(const Array<UserTokenPolicy>& policies,
                                                       const channel::SecuritySetting& security,
                                                       const UserIdentity& identity);

struct UserToken {
    ExtensionObject token;
    /// Of a user certificate; null for others.
    SignatureData signature;
};

/// Part 4, 7.40. A secret is encrypted for a server certificate that has passed the validator, or
/// not sent: Bad_SecurityPolicyRejected, or what the validator says.
[[nodiscard]] Result<UserToken> make_user_token(const ConnectionConfig& config,
                                                const channel::ChannelEnvironment& environment,
                                                const UserTokenPolicy& policy,
                                                const ByteString& server_nonce);

} // namespace busbar::client::detail
