#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/security_policy.hpp>

/// RSA as the policies use it (Part 6, 6.7.4). Every failure is Bad_SecurityChecksFailed: a peer
/// must not learn which step failed. A key that the policy does not allow, and any use of policy
/// None, is such a failure too. Any thread.
namespace busbar::crypto {

using Bytes = std::vector<std::byte>;

/// What one message may make the receiver's private key do; an OpenSecureChannel needs about five.
inline constexpr std::size_t max_cipher_blocks = 32;
/// The legacy format is for secrets of at most this size (Part 4, 7.40.2.1), bound to a nonce of
/// at least that size (Part 4, 5.7.2.2). In bytes.
inline constexpr std::size_t max_secret_size = 64;
inline constexpr std::size_t min_server_nonce_size = 32;

[[nodiscard]] Result<Bytes> asymmetric_sign(const SecurityPolicy& policy, const PrivateKey& key,
                                            std::span<const std::byte> data);
[[nodiscard]] Result<void> asymmetric_verify(const SecurityPolicy& policy,
                                             const Certificate& certificate,
                                             std::span<const std::byte> data,
                                             std::span<const std::byte> signature);

/// Bytes of plain text in one block of a key with `key_size` bytes; 0 if the key is too small.
[[nodiscard]] std::size_t plain_block_size(const SecurityPolicy& policy, std::size_t key_size);

/// Block by block, of what is not empty; the last block's text may be shorter than the others'. All
/// blocks are always decrypted, whichever is wrong; max_cipher_blocks at most.
[[nodiscard]] Result<Bytes> asymmetric_encrypt(const SecurityPolicy& policy,
                                               const Certificate& certificate,
                                               std::span<const std::byte> plain);
[[nodiscard]] Result<Bytes> asymmetric_decrypt(const SecurityPolicy& policy, const PrivateKey& key,
                                               std::span<const std::byte> cipher);

/// The secret of a UserNameIdentityToken: length, secret and the server's nonce, encrypted
/// (Part 4, 7.40.2.2). The nonce is the last one of the session; a secret that was encrypted for
/// another one is refused. An empty secret comes back as such: the caller decides what it is worth.
[[nodiscard]] Result<Bytes> encrypt_secret(const SecurityPolicy& policy,
                                           const Certificate& certificate,
                                           std::span<const std::byte> secret,
                                           std::span<const std::byte> server_nonce);
[[nodiscard]] Result<Secret> decrypt_secret(const SecurityPolicy& policy, const PrivateKey& key,
                                            std::span<const std::byte> cipher,
                                            std::span<const std::byte> server_nonce);

} // namespace busbar::crypto
