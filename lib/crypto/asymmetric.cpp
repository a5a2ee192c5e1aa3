#include <busbar/crypto/asymmetric.hpp>

#include <openssl/core_names.h>
#include <openssl/err.h>
#include <openssl/rand.h>
#include <openssl/rsa.h>

#include <algorithm>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

/// One status for every failure, and nothing left in OpenSSL's error queue.
auto failed()
{
    ERR_clear_error();
    return fail(status::Bad_SecurityChecksFailed);
}

/// Part 7: a policy names the keys that it may be used with; None has no keys at all.
bool allows_key(const SecurityPolicy& policy, std::size_t bits)
{
    return !policy.is_none() && bits >= policy.min_key_bits && bits <= policy.max_key_bits;
}

std::size_t bits_of(const PrivateKey& key)
{
    return static_cast<std::size_t>(EVP_PKEY_get_bits(key.native()));
}

const EVP_MD* signature_digest(const SecurityPolicy& policy)
{
    return policy.signature == AsymmetricSignature::Pkcs1Sha1 ? EVP_sha1() : EVP_sha256();
}

bool set_signature_padding(EVP_PKEY_CTX* context, const SecurityPolicy& policy)
{
    if (policy.signature != AsymmetricSignature::PssSha256) {
        return EVP_PKEY_CTX_set_rsa_padding(context, RSA_PKCS1_PADDING) == 1;
    }
    return EVP_PKEY_CTX_set_rsa_padding(context, RSA_PKCS1_PSS_PADDING) == 1 &&
           EVP_PKEY_CTX_set_rsa_pss_saltlen(context, RSA_PSS_SALTLEN_DIGEST) == 1;
}

bool set_encryption_padding(EVP_PKEY_CTX* context, const SecurityPolicy& policy)
{
    if (policy.encryption == AsymmetricEncryption::Pkcs1) {
        return EVP_PKEY_CTX_set_rsa_padding(context, RSA_PKCS1_PADDING) == 1;
    }
    const EVP_MD* digest =
        policy.encryption == AsymmetricEncryption::OaepSha256 ? EVP_sha256() : EVP_sha1();
    return EVP_PKEY_CTX_set_rsa_padding(context, RSA_PKCS1_OAEP_PADDING) == 1 &&
           EVP_PKEY_CTX_set_rsa_oaep_md(context, digest) == 1 &&
           EVP_PKEY_CTX_set_rsa_mgf1_md(context, digest) == 1;
}

/// Returns the bytes that the padding adds to a block: with OAEP two digests and two bytes (RFC
/// 8017, 7.1.1), with PKCS#1 v1.5 eleven bytes (RFC 8017, 7.2.1).
std::size_t padding_size(const SecurityPolicy& policy)
{
    switch (policy.encryption) {
    case AsymmetricEncryption::Pkcs1:
        return 11;
    case AsymmetricEncryption::OaepSha256:
        return 66;
    default:
        return 42;
    }
}

/// Copies the first `length` bytes of `from` over those of `to`. The time it takes depends on the
/// size of `to` only: `length` is secret.
void overlay(std::span<std::byte> to, std::span<const std::byte> from, std::size_t length)
{
    constexpr unsigned top_bit = sizeof(std::size_t) * 8 - 1;
    for (std::size_t i = 0; i < to.size(); ++i) {
        const std::size_t is_before = (i - length) >> top_bit; // 1 if i < length
        const auto mask = static_cast<std::byte>(0 - is_before);
        to[i] = (from[i] & mask) | (to[i] & ~mask);
    }
}

/// True if OpenSSL would refuse the number in `signature` without calculating.
bool exceeds_modulus(EVP_PKEY* key, std::span<const std::byte> signature)
{
    BIGNUM* modulus = nullptr;
    BIGNUM* const number =
        BN_bin2bn(detail::bytes_of(signature), static_cast<int>(signature.size()), nullptr);
    const bool exceeds = number == nullptr ||
                         EVP_PKEY_get_bn_param(key, OSSL_PKEY_PARAM_RSA_N, &modulus) != 1 ||
                         BN_cmp(number, modulus) >= 0;
    BN_free(modulus);
    BN_free(number);
    return exceeds;
}

bool verify(const SecurityPolicy& policy, EVP_PKEY* key, std::span<const std::byte> data,
            std::span<const std::byte> signature)
{
    const detail::DigestContext context{EVP_MD_CTX_new()};
    EVP_PKEY_CTX* parameters = nullptr;
    return context &&
           EVP_DigestVerifyInit(context.get(), &parameters, signature_digest(policy), nullptr,
                                key) == 1 &&
           set_signature_padding(parameters, policy) &&
           EVP_DigestVerify(context.get(), detail::bytes_of(signature), signature.size(),
                            detail::bytes_of(data), data.size()) == 1;
}

} // namespace

Result<Bytes> asymmetric_sign(const SecurityPolicy& policy, const PrivateKey& key,
                              std::span<const std::byte> data)
{
    const detail::DigestContext context{EVP_MD_CTX_new()};
    EVP_PKEY_CTX* parameters = nullptr;
    Bytes signature(key.key_size());
    std::size_t size = signature.size();
    if (!context || !allows_key(policy, bits_of(key)) ||
        EVP_DigestSignInit(context.get(), &parameters, signature_digest(policy), nullptr,
                           key.native()) != 1 ||
        !set_signature_padding(parameters, policy) ||
        EVP_DigestSign(context.get(), detail::bytes_of(std::span{signature}), &size,
                       detail::bytes_of(data), data.size()) != 1) {
        return failed();
    }
    signature.resize(size);
    return signature;
}

Result<void> asymmetric_verify(const SecurityPolicy& policy, const Certificate& certificate,
                               std::span<const std::byte> data,
                               std::span<const std::byte> signature)
{
    EVP_PKEY* const key = X509_get0_pubkey(certificate.native());
    if (!allows_key(policy, certificate.key_bits()) || signature.size() != certificate.key_size()) {
        return failed();
    }
    // Random bytes in place of a signature are often such a number. A smaller one takes as long as
    // any.
    if (exceeds_modulus(key, signature)) {
        Bytes smaller{signature.begin(), signature.end()};
        smaller.front() = std::byte{0};
        static_cast<void>(verify(policy, key, data, smaller));
        return failed();
    }
    if (!verify(policy, key, data, signature)) {
        return failed();
    }
    return {};
}

std::size_t plain_block_size(const SecurityPolicy& policy, std::size_t key_size)
{
    const std::size_t padding = padding_size(policy);
    return key_size > padding ? key_size - padding : 0;
}

Result<Bytes> asymmetric_encrypt(const SecurityPolicy& policy, const Certificate& certificate,
                                 std::span<const std::byte> plain)
{
    const std::size_t key_size = certificate.key_size();
    const std::size_t block = plain_block_size(policy, key_size);
    const detail::PkeyContext context{
        EVP_PKEY_CTX_new(X509_get0_pubkey(certificate.native()), nullptr)};
    if (!context || plain.empty() || !allows_key(policy, certificate.key_bits()) || block == 0 ||
        EVP_PKEY_encrypt_init(context.get()) != 1 ||
        !set_encryption_padding(context.get(), policy)) {
        return failed();
    }
    Bytes cipher((plain.size() + block - 1) / block * key_size);
    for (std::span out{cipher}; !out.empty(); out = out.subspan(key_size)) {
        const auto text = plain.first(std::min(block, plain.size()));
        std::size_t size = key_size;
        if (EVP_PKEY_encrypt(context.get(), detail::bytes_of(out), &size, detail::bytes_of(text),
                             text.size()) != 1) {
            return failed();
        }
        plain = plain.subspan(text.size());
    }
    return cipher;
}

Result<Bytes> asymmetric_decrypt(const SecurityPolicy& policy, const PrivateKey& key,
                                 std::span<const std::byte> cipher)
{
    const std::size_t key_size = key.key_size();
    const std::size_t block = plain_block_size(policy, key_size);
    const std::size_t blocks = cipher.size() / key_size;
    const detail::PkeyContext context{EVP_PKEY_CTX_new(key.native(), nullptr)};
    if (!context || !allows_key(policy, bits_of(key)) || block == 0 || blocks == 0 ||
        cipher.size() % key_size != 0 || blocks > max_cipher_blocks ||
        EVP_PKEY_decrypt_init(context.get()) != 1 ||
        !set_encryption_padding(context.get(), policy)) {
        return failed();
    }
    // Implicit rejection: all bytes are random until a text replaces them.
    Bytes plain(blocks * block);
    if (RAND_bytes(detail::bytes_of(std::span{plain}), static_cast<int>(plain.size())) != 1) {
        return failed();
    }
    Bytes text(key_size);
    for (std::span out{plain}; !out.empty(); out = out.subspan(block)) {
        std::size_t size = text.size();
        const bool is_text = EVP_PKEY_decrypt(context.get(), detail::bytes_of(std::span{text}),
                                              &size, detail::bytes_of(cipher), key_size) == 1;
        overlay(out.first(block), text, size & (0 - static_cast<std::size_t>(is_text)));
        cipher = cipher.subspan(key_size);
    }
    cleanse(text);
    ERR_clear_error();
    return plain;
}

Result<Bytes> encrypt_secret(const SecurityPolicy& policy, const Certificate& certificate,
                             std::span<const std::byte> secret,
                             std::span<const std::byte> server_nonce, std::size_t max_size)
{
    if (secret.size() > max_size || server_nonce.size() < min_server_nonce_size) {
        return failed();
    }
    const auto length = static_cast<std::uint32_t>(secret.size() + server_nonce.size());
    Bytes plain;
    plain.reserve(4 + length); // growing would leave copies behind
    for (unsigned shift = 0; shift < 32; shift += 8) {
        plain.push_back(static_cast<std::byte>(length >> shift));
    }
    plain.insert(plain.end(), secret.begin(), secret.end());
    plain.insert(plain.end(), server_nonce.begin(), server_nonce.end());
    auto cipher = asymmetric_encrypt(policy, certificate, plain);
    cleanse(plain);
    return cipher;
}

Result<Secret> decrypt_secret(const SecurityPolicy& policy, const PrivateKey& key,
                              std::span<const std::byte> cipher,
                              std::span<const std::byte> server_nonce, std::size_t max_size)
{
    auto plain = asymmetric_decrypt(policy, key, cipher);
    if (!plain) {
        return fail(plain.error());
    }
    Secret all{*plain};
    cleanse(*plain);
    const auto bytes = all.span();
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4 && i < bytes.size(); ++i) {
        length |= std::to_integer<std::size_t>(bytes[i]) << (8 * i);
    }
    // Part 4, 7.40.2.2: the bytes that the length covers end with the nonce of this session. Some
    // clients fill the last block after it, so that the text may be longer.
    if (server_nonce.size() < min_server_nonce_size || bytes.size() < 4 ||
        length > bytes.size() - 4 || length < server_nonce.size() ||
        length - server_nonce.size() > max_size ||
        !equal_in_constant_time(
            bytes.subspan(4 + length - server_nonce.size(), server_nonce.size()), server_nonce)) {
        return failed();
    }
    return Secret{bytes.subspan(4, length - server_nonce.size())};
}

} // namespace busbar::crypto
