#pragma once

#include <span>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/types/session.hpp>

namespace busbar::harness::detail {

/// Returns 32 random bytes (Part 4, 5.7.2.2).
[[nodiscard]] ByteString new_nonce(crypto::Random& random);

/// Returns the signature over the peer's certificate and nonce that both sides of a session owe
/// each other (Part 4, 5.7.2.2 and 5.7.3.2); null without security, or without an identity.
[[nodiscard]] Result<SignatureData> sign_nonce(const channel::SecuritySetting& security,
                                               const channel::ApplicationIdentity* identity,
                                               std::span<const std::byte> certificate,
                                               std::span<const std::byte> nonce);

/// Returns whether a peer has signed one of these certificates of ours and our nonce: the chain
/// that was sent, or its leaf, of which peers sign either.
[[nodiscard]] bool
is_signed_nonce(const crypto::SecurityPolicy& policy, const crypto::Certificate& signer,
                const channel::ApplicationIdentity& own, std::span<const std::byte> chain,
                std::span<const std::byte> nonce, const SignatureData& signature);

/// Returns the id of the policy for anonymous users of the endpoint with this security; null if
/// there is none.
[[nodiscard]] String anonymous_policy(const Array<EndpointDescription>& endpoints,
                                      const channel::SecuritySetting& security);

} // namespace busbar::harness::detail
