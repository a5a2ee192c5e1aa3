#include <busbar/crypto/symmetric.hpp>

#include <array>
#include <climits>

#include <openssl/core_names.h>
#include <openssl/kdf.h>
#include <openssl/params.h>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

using Kdf = std::unique_ptr<EVP_KDF, detail::FreeWith<EVP_KDF_free>>;
using KdfContext = std::unique_ptr<EVP_KDF_CTX, detail::FreeWith<EVP_KDF_CTX_free>>;

constexpr std::size_t max_hmac_size = 32;
constexpr std::size_t aes_block_size = 16;

OSSL_PARAM octets(const char* name, std::span<const std::byte> bytes)
{
    return OSSL_PARAM_construct_octet_string(name, const_cast<std::byte*>(bytes.data()),
                                             bytes.size());
}

/// Returns OpenSSL's name of the policy's digest.
OSSL_PARAM digest_name(const char* key, const SecurityPolicy& policy)
{
    const char* name = policy.digest == SymmetricDigest::Sha1 ? "SHA1" : "SHA256";
    return OSSL_PARAM_construct_utf8_string(key, const_cast<char*>(name), 0);
}

/// P_hash of RFC 5246, 5, which OpenSSL has as the TLS 1.2 PRF.
bool p_hash(const SecurityPolicy& policy, std::span<const std::byte> secret,
            std::span<const std::byte> seed, std::span<std::byte> out)
{
    const Kdf kdf{EVP_KDF_fetch(nullptr, "TLS1-PRF", nullptr)};
    const KdfContext context{kdf ? EVP_KDF_CTX_new(kdf.get()) : nullptr};
    const std::array parameters = {digest_name(OSSL_KDF_PARAM_DIGEST, policy),
                                   octets(OSSL_KDF_PARAM_SECRET, secret),
                                   octets(OSSL_KDF_PARAM_SEED, seed), OSSL_PARAM_construct_end()};
    return context &&
           EVP_KDF_derive(context.get(), detail::bytes_of(out), out.size(), parameters.data()) == 1;
}

/// Returns null for a key size that AES does not have.
const EVP_CIPHER* cipher_of(const SecurityPolicy& policy)
{
    switch (policy.encrypting_key_size) {
    case 16:
        return EVP_aes_128_cbc();
    case 32:
        return EVP_aes_256_cbc();
    default:
        return nullptr;
    }
}

} // namespace

Result<SymmetricKeys> derive_keys(const SecurityPolicy& policy, std::span<const std::byte> secret,
                                  std::span<const std::byte> seed)
{
    if (policy.is_none()) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    Secret all{policy.signing_key_size + policy.encrypting_key_size + policy.block_size};
    if (!p_hash(policy, secret, seed, all.span())) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    const auto bytes = all.span();
    return SymmetricKeys{Secret{bytes.first(policy.signing_key_size)},
                         Secret{bytes.subspan(policy.signing_key_size, policy.encrypting_key_size)},
                         Secret{bytes.last(policy.block_size)}};
}

struct SymmetricCipher::Contexts {
    detail::CipherContext encryption;
    detail::CipherContext decryption;
    detail::MacContext mac;
    Secret initialization_vector;
};

namespace {

bool prepare_cipher(EVP_CIPHER_CTX* context, const SecurityPolicy& policy,
                    const SymmetricKeys& keys, int is_encrypting)
{
    const EVP_CIPHER* cipher = cipher_of(policy);
    return context != nullptr && cipher != nullptr && policy.block_size == aes_block_size &&
           EVP_CipherInit_ex2(context, cipher, detail::bytes_of(keys.encrypting_key.span()),
                              detail::bytes_of(keys.initialization_vector.span()), is_encrypting,
                              nullptr) == 1 &&
           EVP_CIPHER_CTX_set_padding(context, 0) == 1;
}

detail::MacContext prepare_mac(const SecurityPolicy& policy, const SymmetricKeys& keys)
{
    const detail::Mac mac{EVP_MAC_fetch(nullptr, "HMAC", nullptr)};
    detail::MacContext context{mac ? EVP_MAC_CTX_new(mac.get()) : nullptr};
    const std::array parameters = {digest_name(OSSL_MAC_PARAM_DIGEST, policy),
                                   OSSL_PARAM_construct_end()};
    const auto key = keys.signing_key.span();
    if (!context ||
        EVP_MAC_init(context.get(), detail::bytes_of(key), key.size(), parameters.data()) != 1) {
        return nullptr;
    }
    return context;
}

/// Keeps the key schedule; only the initialization vector is set again for each chunk.
bool crypt(EVP_CIPHER_CTX* context, const Secret& vector, int is_encrypting,
           std::span<std::byte> data)
{
    int size = 0;
    return data.size() <= static_cast<std::size_t>(INT_MAX) && data.size() % vector.size() == 0 &&
           EVP_CipherInit_ex2(context, nullptr, nullptr, detail::bytes_of(vector.span()),
                              is_encrypting, nullptr) == 1 &&
           EVP_CipherUpdate(context, detail::bytes_of(data), &size, detail::bytes_of(data),
                            static_cast<int>(data.size())) == 1 &&
           static_cast<std::size_t>(size) == data.size();
}

} // namespace

SymmetricCipher::SymmetricCipher(std::unique_ptr<Contexts> contexts)
    : contexts_{std::move(contexts)}
{
}
SymmetricCipher::SymmetricCipher(SymmetricCipher&&) noexcept = default;
SymmetricCipher& SymmetricCipher::operator=(SymmetricCipher&&) noexcept = default;
SymmetricCipher::~SymmetricCipher() = default;

Result<SymmetricCipher> SymmetricCipher::create(const SecurityPolicy& policy,
                                                const SymmetricKeys& keys)
{
    if (policy.is_none() || keys.signing_key.size() != policy.signing_key_size ||
        keys.encrypting_key.size() != policy.encrypting_key_size ||
        keys.initialization_vector.size() != policy.block_size) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    auto contexts = std::make_unique<Contexts>();
    contexts->encryption.reset(EVP_CIPHER_CTX_new());
    contexts->decryption.reset(EVP_CIPHER_CTX_new());
    contexts->mac = prepare_mac(policy, keys);
    contexts->initialization_vector = Secret{keys.initialization_vector.span()};
    if (!prepare_cipher(contexts->encryption.get(), policy, keys, 1) ||
        !prepare_cipher(contexts->decryption.get(), policy, keys, 0) || !contexts->mac) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    return SymmetricCipher{std::move(contexts)};
}

bool SymmetricCipher::sign(std::span<const std::byte> data, std::span<std::byte> signature)
{
    EVP_MAC_CTX* mac = contexts_->mac.get();
    std::size_t size = 0;
    return EVP_MAC_init(mac, nullptr, 0, nullptr) == 1 &&
           EVP_MAC_update(mac, detail::bytes_of(data), data.size()) == 1 &&
           EVP_MAC_final(mac, detail::bytes_of(signature), &size, signature.size()) == 1 &&
           size == signature.size();
}

bool SymmetricCipher::verify(std::span<const std::byte> data, std::span<const std::byte> signature)
{
    std::array<std::byte, max_hmac_size> buffer{};
    if (signature.size() > buffer.size()) {
        return false;
    }
    const auto expected = std::span{buffer}.first(signature.size());
    return sign(data, expected) && equal_in_constant_time(expected, signature);
}

bool SymmetricCipher::encrypt(std::span<std::byte> data)
{
    return crypt(contexts_->encryption.get(), contexts_->initialization_vector, 1, data);
}

bool SymmetricCipher::decrypt(std::span<std::byte> data)
{
    return crypt(contexts_->decryption.get(), contexts_->initialization_vector, 0, data);
}

} // namespace busbar::crypto
