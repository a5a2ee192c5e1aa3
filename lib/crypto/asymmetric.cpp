#include <busbar/crypto/asymmetric.hpp>

#include <openssl/err.h>
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
    const EVP_MD* digest =
        policy.encryption == AsymmetricEncryption::OaepSha256 ? EVP_sha256() : EVP_sha1();
    return EVP_PKEY_CTX_set_rsa_padding(context, RSA_PKCS1_OAEP_PADDING) == 1 &&
           EVP_PKEY_CTX_set_rsa_oaep_md(context, digest) == 1 &&
           EVP_PKEY_CTX_set_rsa_mgf1_md(context, digest) == 1;
}

/// What OAEP adds to a block: two digests and two bytes (RFC 8017, 7.1.1).
std::size_t padding_size(const SecurityPolicy& policy)
{
    return policy.encryption == AsymmetricEncryption::OaepSha256 ? 66 : 42;
}

using Step = int (*)(EVP_PKEY_CTX*, unsigned char*, std::size_t*, const unsigned char*,
                     std::size_t);

/// Applies `step` to `in` in blocks of `block` bytes.
Result<Bytes> by_blocks(EVP_PKEY_CTX* context, Step step, std::span<const std::byte> in,
                        std::size_t block, std::size_t key_size)
{
    Bytes out;
    Bytes part(key_size);
    out.reserve((in.size() / block + 1) * key_size);
    bool is_good = true;
    while (!in.empty()) {
        const auto from = in.first(std::min(block, in.size()));
        std::size_t size = part.size();
        is_good = step(context, detail::bytes_of(std::span{part}), &size, detail::bytes_of(from),
                       from.size()) == 1 &&
                  is_good;
        out.insert(out.end(), part.begin(),
                   part.begin() + static_cast<std::ptrdiff_t>(is_good ? size : 0));
        in = in.subspan(from.size());
    }
    cleanse(part);
    if (!is_good) {
        cleanse(out);
        return failed();
    }
    return out;
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
        EVP_DigestSignInit(context.get(), &parameters, EVP_sha256(), nullptr, key.native()) != 1 ||
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
    const detail::DigestContext context{EVP_MD_CTX_new()};
    EVP_PKEY_CTX* parameters = nullptr;
    if (!context || !allows_key(policy, certificate.key_bits()) ||
        EVP_DigestVerifyInit(context.get(), &parameters, EVP_sha256(), nullptr,
                             X509_get0_pubkey(certificate.native())) != 1 ||
        !set_signature_padding(parameters, policy) ||
        EVP_DigestVerify(context.get(), detail::bytes_of(signature), signature.size(),
                         detail::bytes_of(data), data.size()) != 1) {
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
    return by_blocks(context.get(), EVP_PKEY_encrypt, plain, block, key_size);
}

Result<Bytes> asymmetric_decrypt(const SecurityPolicy& policy, const PrivateKey& key,
                                 std::span<const std::byte> cipher)
{
    const std::size_t key_size = key.key_size();
    const detail::PkeyContext context{EVP_PKEY_CTX_new(key.native(), nullptr)};
    if (!context || !allows_key(policy, bits_of(key)) || cipher.empty() ||
        cipher.size() % key_size != 0 || cipher.size() / key_size > max_cipher_blocks ||
        EVP_PKEY_decrypt_init(context.get()) != 1 ||
        !set_encryption_padding(context.get(), policy)) {
        return failed();
    }
    return by_blocks(context.get(), EVP_PKEY_decrypt, cipher, key_size, key_size);
}

Result<Bytes> encrypt_secret(const SecurityPolicy& policy, const Certificate& certificate,
                             std::span<const std::byte> secret,
                             std::span<const std::byte> server_nonce)
{
    if (secret.size() > max_secret_size || server_nonce.size() < min_server_nonce_size) {
        return failed();
    }
    const auto length = static_cast<std::uint32_t>(secret.size() + server_nonce.size());
    Bytes plain;
    plain.reserve(4 + length); // no copies left behind by growing
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
                              std::span<const std::byte> server_nonce)
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
    // Part 4, 7.40.2.2: what the length covers ends with the nonce of this session. Some clients
    // fill the last block behind it, so that the text may be longer.
    if (server_nonce.size() < min_server_nonce_size || bytes.size() < 4 ||
        length > bytes.size() - 4 || length < server_nonce.size() ||
        length - server_nonce.size() > max_secret_size ||
        !equal_in_constant_time(
            bytes.subspan(4 + length - server_nonce.size(), server_nonce.size()), server_nonce)) {
        return failed();
    }
    return Secret{bytes.subspan(4, length - server_nonce.size())};
}

} // namespace busbar::crypto
