#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/security_policy.hpp>

/// RSA as the policies use it (Part 6, 6.7.4). Every failure is Bad_SecurityChecksFailed, since a
/// peer must not learn which step failed; a failure that can depend on a secret takes as much work
/// as success. A key that the policy does not allow, and any use of policy None, fails as well.
/// Called from any thread.
namespace busbar::crypto {

/// Owned bytes, such as a signature or a ciphertext.
using Bytes = std::vector<std::byte>;

/// The maximum number of blocks that the receiver's private key decrypts for one secret.
inline constexpr std::size_t max_cipher_blocks = 32;
/// The legacy format is for secrets of at most this size (Part 4, 7.40.2.1), bound to a nonce of at
/// least that size (Part 4, 5.7.2.2). In bytes.
inline constexpr std::size_t max_secret_size = 64;
inline constexpr std::size_t min_server_nonce_size = 32;

/// Signs or verifies as the policy says.
[[nodiscard]] BUSBAR_API Result<Bytes> asymmetric_sign(const SecurityPolicy& policy,
                                                       const PrivateKey& key,
                                                       std::span<const std::byte> data);
[[nodiscard]] BUSBAR_API Result<void> asymmetric_verify(const SecurityPolicy& policy,
                                                        const Certificate& certificate,
                                                        std::span<const std::byte> data,
                                                        std::span<const std::byte> signature);

/// Returns how many bytes of plain text one block holds for a key of `key_size` bytes; 0 if the key
/// is too small.
[[nodiscard]] BUSBAR_API std::size_t plain_block_size(const SecurityPolicy& policy,
                                                      std::size_t key_size);

/// Encrypts a text that must not be empty, block by block; the last block may hold less text than
/// the others.
[[nodiscard]] BUSBAR_API Result<Bytes> asymmetric_encrypt(const SecurityPolicy& policy,
                                                          const Certificate& certificate,
                                                          std::span<const std::byte> plain);
/// Decrypts at most max_cipher_blocks blocks; the result has plain_block_size bytes for each block
/// of `cipher`. A block that does not decrypt yields random bytes, and a block with a shorter text
/// is filled up with random bytes: only the caller's next check, of a signature or a nonce, tells
/// whether this is what was sent, and no peer can tell a padding error from another (implicit
/// rejection, RFC 5246, 7.4.7.1). Fails only for what any peer can see: the key and the size of
/// `cipher`.
[[nodiscard]] BUSBAR_API Result<Bytes> asymmetric_decrypt(const SecurityPolicy& policy,
                                                          const PrivateKey& key,
                                                          std::span<const std::byte> cipher);

/// Encrypts and decrypts the secret of a UserNameIdentityToken: length, secret and the server's
/// nonce (Part 4, 7.40.2.2). The nonce is the last one of the session; a secret that was encrypted
/// for another nonce is refused. An empty secret comes back as empty: the caller decides what that
/// means. Issued tokens have the same format and may be larger than passwords.
[[nodiscard]] BUSBAR_API Result<Bytes> encrypt_secret(const SecurityPolicy& policy,
                                                      const Certificate& certificate,
                                                      std::span<const std::byte> secret,
                                                      std::span<const std::byte> server_nonce,
                                                      std::size_t max_size = max_secret_size);
[[nodiscard]] BUSBAR_API Result<Secret> decrypt_secret(const SecurityPolicy& policy,
                                                       const PrivateKey& key,
                                                       std::span<const std::byte> cipher,
                                                       std::span<const std::byte> server_nonce,
                                                       std::size_t max_size = max_secret_size);

} // namespace busbar::crypto
