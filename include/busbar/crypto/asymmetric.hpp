#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/security_policy.hpp>

/// RSA as the policies use it (Part 6, 6.7.4). Every failure is Bad_SecurityChecksFailed: a peer
/// must not learn which step failed.
namespace busbar::crypto {

using Bytes = std::vector<std::byte>;

[[nodiscard]] Result<Bytes> asymmetric_sign(const SecurityPolicy& policy, const PrivateKey& key,
                                            std::span<const std::byte> data);
[[nodiscard]] Result<void> asymmetric_verify(const SecurityPolicy& policy,
                                             const Certificate& certificate,
                                             std::span<const std::byte> data,
                                             std::span<const std::byte> signature);

/// Bytes of plain text in one block of a key with `key_size` bytes; 0 if the key is too small.
[[nodiscard]] std::size_t plain_block_size(const SecurityPolicy& policy, std::size_t key_size);

/// Block by block; the last block may be shorter than the others.
[[nodiscard]] Result<Bytes> asymmetric_encrypt(const SecurityPolicy& policy,
                                               const Certificate& certificate,
                                               std::span<const std::byte> plain);
[[nodiscard]] Result<Bytes> asymmetric_decrypt(const SecurityPolicy& policy, const PrivateKey& key,
                                               std::span<const std::byte> cipher);

/// The secret of a UserNameIdentityToken: length, secret and the server's nonce, encrypted
/// (Part 4, 7.40.2.2).
[[nodiscard]] Result<Bytes> encrypt_secret(const SecurityPolicy& policy,
                                           const Certificate& certificate,
                                           std::span<const std::byte> secret,
                                           std::span<const std::byte> server_nonce);
[[nodiscard]] Result<Secret> decrypt_secret(const SecurityPolicy& policy, const PrivateKey& key,
                                            std::span<const std::byte> cipher,
                                            std::span<const std::byte> server_nonce);

} // namespace busbar::crypto
