#include <busbar/crypto/jwt.hpp>

#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/hmac.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>

#include <array>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

constexpr std::size_t min_shared_secret_size = 32; // RFC 7518, 3.2
constexpr int min_rsa_bits = 2'048;                // RFC 7518, 3.3
constexpr int max_rsa_bits = 8'192;
constexpr std::size_t p256_size = 32; // bytes of each half of a signature (RFC 7518, 3.4)

using Bytes = std::vector<std::byte>;
using EcdsaSignature = std::unique_ptr<ECDSA_SIG, detail::FreeWith<ECDSA_SIG_free>>;

/// Prevents OpenSSL from asking a terminal for a passphrase.
int no_passphrase(char*, int, int, void*)
{
    return 0;
}

bool is_p256(const EVP_PKEY* key)
{
    std::array<char, 32> group{};
    std::size_t size = 0;
    return EVP_PKEY_get_base_id(key) == EVP_PKEY_EC &&
           EVP_PKEY_get_group_name(key, group.data(), group.size(), &size) == 1 &&
           std::string_view{group.data(), size} == "prime256v1";
}

bool is_for(const EVP_PKEY* key, JwtAlgorithm algorithm)
{
    switch (algorithm) {
    case JwtAlgorithm::RS256:
    case JwtAlgorithm::PS256:
        return EVP_PKEY_get_base_id(key) == EVP_PKEY_RSA &&
               EVP_PKEY_get_bits(key) >= min_rsa_bits && EVP_PKEY_get_bits(key) <= max_rsa_bits;
    case JwtAlgorithm::ES256:
        return is_p256(key);
    case JwtAlgorithm::HS256:
        break; // a public key is not secret
    }
    return false;
}

/// Encodes the two numbers of an ECDSA signature for OpenSSL; empty if they are invalid.
Bytes to_der(std::span<const std::byte> signature)
{
    if (signature.size() != 2 * p256_size) {
        return {};
    }
    const EcdsaSignature numbers{ECDSA_SIG_new()};
    BIGNUM* r = BN_bin2bn(detail::bytes_of(signature.first(p256_size)), p256_size, nullptr);
    BIGNUM* s = BN_bin2bn(detail::bytes_of(signature.subspan(p256_size)), p256_size, nullptr);
    if (!numbers || ECDSA_SIG_set0(numbers.get(), r, s) != 1) {
        BN_free(r);
        BN_free(s);
        return {};
    }
    unsigned char* der = nullptr;
    const int size = i2d_ECDSA_SIG(numbers.get(), &der);
    const detail::DerPointer owned{der};
    Bytes bytes;
    if (size > 0) {
        const auto* first = reinterpret_cast<const std::byte*>(der);
        bytes.assign(first, first + size);
    }
    return bytes;
}

bool verify_with_key(EVP_PKEY* key, JwtAlgorithm algorithm, std::string_view text,
                     std::span<const std::byte> signature)
{
    const detail::DigestContext context{EVP_MD_CTX_new()};
    EVP_PKEY_CTX* parameters = nullptr;
    const Bytes der = algorithm == JwtAlgorithm::ES256 ? to_der(signature) : Bytes{};
    const auto given =
        algorithm == JwtAlgorithm::ES256 ? std::span<const std::byte>{der} : signature;
    const bool is_pss = algorithm == JwtAlgorithm::PS256;
    const bool is_good =
        context && !given.empty() &&
        EVP_DigestVerifyInit(context.get(), &parameters, EVP_sha256(), nullptr, key) == 1 &&
        (!is_pss || (EVP_PKEY_CTX_set_rsa_padding(parameters, RSA_PKCS1_PSS_PADDING) == 1 &&
                     EVP_PKEY_CTX_set_rsa_pss_saltlen(parameters, RSA_PSS_SALTLEN_DIGEST) == 1)) &&
        EVP_DigestVerify(context.get(), detail::bytes_of(given), given.size(),
                         reinterpret_cast<const unsigned char*>(text.data()), text.size()) == 1;
    ERR_clear_error();
    return is_good;
}

bool verify_with_secret(const Secret& secret, std::string_view text,
                        std::span<const std::byte> signature)
{
    std::array<std::byte, 32> mac{};
    unsigned size = 0;
    const bool is_made = HMAC(EVP_sha256(), secret.span().data(), static_cast<int>(secret.size()),
                              reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                              detail::bytes_of(std::span<std::byte>{mac}), &size) != nullptr;
    return is_made && equal_in_constant_time(mac, signature);
}

} // namespace

std::string_view name(JwtAlgorithm algorithm)
{
    static constexpr std::array<std::string_view, 4> names{"RS256", "PS256", "ES256", "HS256"};
    return names[static_cast<std::size_t>(algorithm)];
}

Result<JwtKey> JwtKey::from_public_key(JwtAlgorithm algorithm, std::span<const std::byte> pem,
                                       std::string id)
{
    const detail::Bio bio = detail::memory_bio(pem);
    JwtKey key{algorithm, std::move(id)};
    key.key_.reset(PEM_read_bio_PUBKEY(bio.get(), nullptr, no_passphrase, nullptr), EVP_PKEY_free);
    ERR_clear_error();
    if (!key.key_ || !is_for(key.key_.get(), algorithm)) {
        return fail(status::Bad_ConfigurationError);
    }
    return key;
}

Result<JwtKey> JwtKey::from_certificate(JwtAlgorithm algorithm, const Certificate& certificate,
                                        std::string id)
{
    JwtKey key{algorithm, std::move(id)};
    key.key_.reset(X509_get_pubkey(certificate.native()), EVP_PKEY_free);
    ERR_clear_error();
    if (!key.key_ || !is_for(key.key_.get(), algorithm)) {
        return fail(status::Bad_ConfigurationError);
    }
    return key;
}

Result<JwtKey> JwtKey::from_shared_secret(std::span<const std::byte> secret, std::string id)
{
    if (secret.size() < min_shared_secret_size || secret.size() > max_jwt_size) {
        return fail(status::Bad_ConfigurationError);
    }
    JwtKey key{JwtAlgorithm::HS256, std::move(id)};
    key.secret_ = std::make_shared<const Secret>(secret);
    return key;
}

bool JwtKey::verify(std::string_view signed_text, std::span<const std::byte> signature) const
{
    return algorithm_ == JwtAlgorithm::HS256
               ? verify_with_secret(*secret_, signed_text, signature)
               : verify_with_key(key_.get(), algorithm_, signed_text, signature);
}

} // namespace busbar::crypto
