#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace busbar::crypto {

enum class AsymmetricSignature : std::uint8_t { None, Pkcs1Sha256, PssSha256 };
enum class AsymmetricEncryption : std::uint8_t { None, OaepSha1, OaepSha256 };

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
    std::size_t symmetric_signature_size{0}; // bytes, HMAC-SHA256
    std::size_t signing_key_size{0};
    std::size_t encrypting_key_size{0};
    std::size_t block_size{1};
    std::size_t nonce_size{0};

    [[nodiscard]] bool is_none() const { return signature == AsymmetricSignature::None; }
};

/// All policies this build knows, None first.
[[nodiscard]] std::span<const SecurityPolicy> security_policies();
/// The policy with this URI or this name, null if there is none.
[[nodiscard]] const SecurityPolicy* find_policy(std::string_view uri);
[[nodiscard]] const SecurityPolicy* find_policy_by_name(std::string_view name);
/// SecurityPolicy None.
[[nodiscard]] const SecurityPolicy& policy_none();

} // namespace busbar::crypto
