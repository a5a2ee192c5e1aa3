#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/security_policy.hpp>

/// RSA as the policies use it (Part 6, 6.7.4). Every failure is Bad_SecurityChecksFailed: a peer
/// must not learn which step failed, and one that can depend on a secret takes as much work as any
/// other. A key that the policy does not allow, and any use of policy None, is a failure too. Any
/// thread.
namespace busbar::crypto {

using Bytes = std::vector<std::byte>;

/// What one secret may make the receiver's private key do.
inline constexpr std::size_t max_cipher_blocks = 32;
/// The legacy format is for secrets of at most this size (Part 4, 7.40.2.1), bound to a nonce of
/// at least that size (Part 4, 5.7.2.2). In bytes.
inline constexpr std::size_t max_secret_size = 64;
inline constexpr std::size_t min_server_nonce_size = 32;

[[nodiscard]] BUSBAR_API Result<Bytes> asymmetric_sign(const SecurityPolicy& policy,
                                                       const PrivateKey& key,
                                                       std::span<const std::byte> data);
[[nodiscard]] BUSBAR_API Result<void> asymmetric_verify(const SecurityPolicy& policy,
                                                        const Certificate& certificate,
                                                        std::span<const std::byte> data,
                                                        std::span<const std::byte> signature);

/// Bytes of plain text in one block of a key with `key_size` bytes; 0 if the key is too small.
[[nodiscard]] BUSBAR_API std::size_t plain_block_size(const SecurityPolicy& policy,
                                                      std::size_t key_size);

/// Block by block, of what is not empty; the last block's text may be shorter than the others'.
[[nodiscard]] BUSBAR_API Result<Bytes> asymmetric_encrypt(const SecurityPolicy& policy,
                                                          const Certificate& certificate,
                                                          std::span<const std::byte> plain);
/// As many plain_block_size as `cipher` has blocks, max_cipher_blocks at most. A block that does
/// not decrypt comes out as chance, and so does what is missing of a block with a shorter text:
/// nothing but the caller's next check, of a signature or of a nonce, tells whether this is what
/// was sent, and no one learns that it was the padding (implicit rejection, RFC 5246, 7.4.7.1). Bad
/// only for what any peer can see: the key and the size of `cipher`.
[[nodiscard]] BUSBAR_API Result<Bytes> asymmetric_decrypt(const SecurityPolicy& policy,
                                                          const PrivateKey& key,
                                                          std::span<const std::byte> cipher);

/// The secret of a UserNameIdentityToken: length, secret and the server's nonce, encrypted
/// (Part 4, 7.40.2.2). The nonce is the last one of the session; a secret that was encrypted for
/// another one is refused. An empty secret comes back as such: the caller decides what it is worth.
/// Issued tokens use the format too, and are larger than passwords may be.
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
