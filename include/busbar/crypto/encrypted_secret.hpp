#pragma once

#include <cstddef>
#include <span>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/crypto/asymmetric.hpp>

/// RsaEncryptedSecret (Part 4, 7.40.2.3 and 7.40.2.4): a secret that is encrypted with keys of its
/// own and signed with one, the keys being encrypted for the receiver. Unlike the legacy format
/// (encrypt_secret) it may hold more than 64 bytes, and a change of any byte is detected. Every
/// failure is Bad_SecurityChecksFailed, and keys that do not decrypt take as much work as keys that
/// do not match the signature, so that a peer cannot tell them apart. Called from any thread.
namespace busbar::crypto {

/// True if `data` begins as such a secret does. The legacy format begins with random bytes, which
/// look the same once in 2^40 times.
[[nodiscard]] BUSBAR_API bool is_encrypted_secret(std::span<const std::byte> data);

/// Encrypts `secret` for the owner of `certificate`, bound to the last `server_nonce` of the
/// session, which has at least min_server_nonce_size bytes; `now` becomes the SigningTime.
[[nodiscard]] BUSBAR_API Result<Bytes> seal_secret(const SecurityPolicy& policy,
                                                   const Certificate& certificate,
                                                   std::span<const std::byte> secret,
                                                   std::span<const std::byte> server_nonce,
                                                   DateTime now);
/// Decrypts what seal_secret() has encrypted for `certificate`, whose key is `key`, under the same
/// policy and nonce. The nonce, which is used once, proves that it is not an older secret;
/// SigningTime is ignored, as a controller may have no clock. A secret of more than `max_size`
/// bytes is refused.
[[nodiscard]] BUSBAR_API Result<Secret>
unseal_secret(const SecurityPolicy& policy, const Certificate& certificate, const PrivateKey& key,
              std::span<const std::byte> data, std::span<const std::byte> server_nonce,
              std::size_t max_size);

} // namespace busbar::crypto
