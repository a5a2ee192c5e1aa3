#pragma once

#include <cstddef>
#include <span>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/types/common.hpp>

namespace busbar::server::detail {

/// Returns a nonce or token of `size` random bytes; Bad_ResourceUnavailable without randomness.
[[nodiscard]] Result<ByteString> random_bytes(crypto::Random& random, std::size_t size);

/// Returns the server's signature over the client's certificate and nonce (Part 4, 5.7.2.2); null
/// with SecurityPolicy None, where `server` may be missing.
[[nodiscard]] Result<SignatureData> sign_for_client(const channel::ApplicationIdentity* server,
                                                    const channel::SecuritySetting& security,
                                                    std::span<const std::byte> client_certificate,
                                                    std::span<const std::byte> client_nonce);

/// True if the client has signed the server's certificate and nonce with the key of its own
/// certificate (Part 4, 5.7.3.2); also without security, which requires no signature.
[[nodiscard]] bool is_signed_by_client(const channel::ApplicationIdentity* server,
                                       const channel::SecuritySetting& security,
                                       const crypto::CertificateChain& client,
                                       std::span<const std::byte> server_nonce,
                                       const SignatureData& signature);

} // namespace busbar::server::detail
