#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::crypto {

/// The AsymmetricSignatureAlgorithm of a policy: RSA with this padding and digest.
enum class AsymmetricSignature : std::uint8_t { None, Pkcs1Sha1, Pkcs1Sha256, PssSha256 };
/// The AsymmetricEncryptionAlgorithm of a policy: RSA with this padding.
enum class AsymmetricEncryption : std::uint8_t { None, Pkcs1, OaepSha1, OaepSha256 };
/// The digest of SymmetricSignatureAlgorithm (HMAC) and KeyDerivationAlgorithm (P_hash), which is
/// one and the same in every policy.
enum class SymmetricDigest : std::uint8_t { Sha1, Sha256 };

/// One security policy of Part 7, 6.6 as data; the channel knows no policy by name.
struct SecurityPolicy {
    std::string_view uri;
    std::string_view name; // "Basic256Sha256"
    AsymmetricSignature signature{AsymmetricSignature::None};
    AsymmetricEncryption encryption{AsymmetricEncryption::None};
    std::string_view signature_uri{};  // SignatureData.algorithm
    std::string_view encryption_uri{}; // UserNameIdentityToken.encryptionAlgorithm
    std::uint32_t min_key_bits{0};     // of RSA keys
    std::uint32_t max_key_bits{0};
    SymmetricDigest digest{SymmetricDigest::Sha256};
    std::size_t symmetric_signature_size{0}; // bytes
    std::size_t signing_key_size{0};         // DerivedSignatureKeyLength
    std::size_t encrypting_key_size{0};
    std::size_t block_size{1};
    std::size_t nonce_size{0}; // SecureChannelNonceLength
    /// CertificateSignatureAlgorithm: certificates signed with SHA-1 are accepted.
    bool allows_sha1_certificates{false};
    /// No longer recommended by Part 7, because of SHA-1 and PKCS#1 v1.5: only for peers that
    /// support nothing better, and never used unless a configuration names it.
    bool is_deprecated{false};

    [[nodiscard]] bool is_none() const { return signature == AsymmetricSignature::None; }
};

/// All policies that this build knows: None, then from the weakest to the strongest. The deprecated
/// ones, Basic128Rsa15 and Basic256, are among them only if BUSBAR_LEGACY_POLICIES was on.
[[nodiscard]] BUSBAR_API std::span<const SecurityPolicy> security_policies();
/// The policy with this URI or this name, null if there is none.
[[nodiscard]] BUSBAR_API const SecurityPolicy* find_policy(std::string_view uri);
[[nodiscard]] BUSBAR_API const SecurityPolicy* find_policy_by_name(std::string_view name);
/// SecurityPolicy None.
[[nodiscard]] BUSBAR_API const SecurityPolicy& policy_none();

} // namespace busbar::crypto
