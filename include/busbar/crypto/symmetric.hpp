#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/crypto/security_policy.hpp>

namespace busbar::crypto {

/// The keys of one direction of a channel (Part 6, 6.7.5).
struct SymmetricKeys {
    Secret signing_key;
    Secret encrypting_key;
    Secret initialization_vector;
};

/// Derives keys with the policy's P_hash. For the client's keys the secret is the server's nonce
/// and the seed the client's; for the server's the other way round (Part 6, 6.7.5; 6.7.6 in later
/// editions). Bad_SecurityChecksFailed with policy None or an empty secret.
[[nodiscard]] BUSBAR_API Result<SymmetricKeys> derive_keys(const SecurityPolicy& policy,
                                                           std::span<const std::byte> secret,
                                                           std::span<const std::byte> seed);

/// Performs AES-CBC and the policy's HMAC with prepared keys: a chunk costs its bytes and no key
/// schedule. Move-only, one thread at a time. It allocates nothing itself after create(); OpenSSL
/// 3.0 creates two small digest contexts for each signature.
class BUSBAR_API SymmetricCipher {
public:
    /// Returns Bad_SecurityChecksFailed if the keys do not have the policy's sizes, as with policy
    /// None.
    [[nodiscard]] static Result<SymmetricCipher> create(const SecurityPolicy& policy,
                                                        const SymmetricKeys& keys);
    SymmetricCipher(SymmetricCipher&&) noexcept;
    SymmetricCipher& operator=(SymmetricCipher&&) noexcept;
    ~SymmetricCipher();

    /// Writes the signature of `data`; `signature` has the policy's symmetric_signature_size.
    [[nodiscard]] bool sign(std::span<const std::byte> data, std::span<std::byte> signature);
    /// True if `signature` is that of `data`; compared in constant time.
    [[nodiscard]] bool verify(std::span<const std::byte> data,
                              std::span<const std::byte> signature);
    /// Encrypts in place. False unless the size is a multiple of the block size.
    [[nodiscard]] bool encrypt(std::span<std::byte> data);
    [[nodiscard]] bool decrypt(std::span<std::byte> data);

private:
    struct Contexts;
    explicit SymmetricCipher(std::unique_ptr<Contexts> contexts);

    std::unique_ptr<Contexts> contexts_;
};

} // namespace busbar::crypto
