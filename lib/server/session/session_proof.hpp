#pragma once

#include <cstddef>
#include <span>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/result.hpp>
#include <busbar/types/common.hpp>

namespace busbar::server::detail {

struct Core;

/// A nonce or token of `size` random bytes; Bad_ResourceUnavailable without randomness.
[[nodiscard]] Result<ByteString> random_bytes(const Core& core, std::size_t size);

/// The server's signature over the client's certificate and nonce (Part 4, 5.7.2.2); null with
/// SecurityPolicy None.
[[nodiscard]] Result<SignatureData> sign_for_client(const Core& core,
                                                    const channel::SecuritySetting& security,
                                                    std::span<const std::byte> client_certificate,
                                                    std::span<const std::byte> client_nonce);

/// True if the key of `signer` has signed the server's certificate and nonce by the policy (Part 4,
/// 5.7.3.2). Never with SecurityPolicy None.
[[nodiscard]] bool is_signed(const channel::ApplicationIdentity& server,
                             const crypto::SecurityPolicy& policy,
                             const crypto::Certificate& signer,
                             std::span<const std::byte> server_nonce,
                             const SignatureData& signature);

/// The same for the application's own certificate; true without security, which asks for none.
[[nodiscard]] bool is_signed_by_client(const Core& core, const channel::SecuritySetting& security,
                                       const crypto::CertificateChain& client,
                                       std::span<const std::byte> server_nonce,
                                       const SignatureData& signature);

} // namespace busbar::server::detail
