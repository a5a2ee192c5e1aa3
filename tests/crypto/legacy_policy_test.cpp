#include <array>

#include <catch2/catch.hpp>

#include <openssl/hmac.h>
#include <openssl/rsa.h>

#include <busbar/crypto/asymmetric.hpp>
#include <busbar/crypto/symmetric.hpp>

#include "crypto/openssl.hpp"
#include "hex.hpp"
#include "issuing.hpp"
#include "support/seeded_random.hpp"

namespace legacy_policy_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Bytes;
using crypto::SecurityPolicy;

namespace {

Bytes random_bytes(std::size_t size, std::uint64_t seed = 1)
{
    SeededRandom random{seed};
    Bytes bytes(size);
    REQUIRE(random.fill(bytes));
    return bytes;
}

Bytes joined(Bytes a, std::span<const std::byte> b)
{
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

Bytes hmac(const EVP_MD* digest, std::span<const std::byte> key, std::span<const std::byte> data)
{
    Bytes mac(EVP_MAX_MD_SIZE);
    unsigned size = 0;
    HMAC(digest, key.data(), static_cast<int>(key.size()), crypto::detail::bytes_of(data),
         data.size(), crypto::detail::bytes_of(std::span{mac}), &size);
    mac.resize(size);
    return mac;
}

/// P_hash as RFC 5246, 5 defines it, step by step.
Bytes p_hash(const EVP_MD* digest, const Bytes& secret, const Bytes& seed, std::size_t size)
{
    Bytes out;
    for (Bytes a = hmac(digest, secret, seed); out.size() < size; a = hmac(digest, secret, a)) {
        out = joined(out, hmac(digest, secret, joined(a, seed)));
    }
    out.resize(size);
    return out;
}

/// What Part 7 says of each policy: sizes in bytes, keys in bits.
struct Row {
    const char* name;
    const EVP_MD* (*digest)();
    std::size_t signature_size;
    std::size_t signing_key_size;
    std::size_t encrypting_key_size;
    std::size_t nonce_size;
    std::uint32_t min_key_bits;
    std::uint32_t max_key_bits;
    int rsa_padding;
};

constexpr std::array rows = {
    Row{"Basic128Rsa15", EVP_sha1, 20, 16, 16, 16, 1024, 2048, RSA_PKCS1_PADDING},
    Row{"Basic256", EVP_sha1, 20, 24, 32, 32, 1024, 2048, RSA_PKCS1_OAEP_PADDING},
    Row{"Basic256Sha256", EVP_sha256, 32, 32, 32, 32, 2048, 4096, RSA_PKCS1_OAEP_PADDING},
    Row{"Aes128_Sha256_RsaOaep", EVP_sha256, 32, 32, 16, 32, 2048, 4096, RSA_PKCS1_OAEP_PADDING},
    Row{"Aes256_Sha256_RsaPss", EVP_sha256, 32, 32, 32, 32, 2048, 4096, RSA_PKCS1_OAEP_PADDING}};

/// The rows of this build.
std::vector<std::pair<Row, const SecurityPolicy*>> known_rows()
{
    std::vector<std::pair<Row, const SecurityPolicy*>> known;
    for (const Row& row : rows) {
        if (const auto* policy = crypto::find_policy_by_name(row.name)) {
            known.emplace_back(row, policy);
        }
    }
    return known;
}

crypto::PrivateKey key_of(std::uint32_t bits)
{
    const crypto::detail::Pkey key{EVP_RSA_gen(bits)};
    unsigned char* der = nullptr;
    const auto size = static_cast<std::size_t>(i2d_PrivateKey(key.get(), &der));
    auto parsed = crypto::PrivateKey::parse(std::as_bytes(std::span{der, size}));
    OPENSSL_free(der);
    return parsed.value();
}

} // namespace

TEST_CASE("the deprecated policies are there only if they were asked for", "[crypto][policy]")
{
    for (const char* name : {"Basic128Rsa15", "Basic256"}) {
        const auto* policy = crypto::find_policy_by_name(name);
        CHECK((policy != nullptr) == (BUSBAR_LEGACY_POLICIES != 0));
        CHECK(policy == crypto::find_policy("http://opcfoundation.org/UA/SecurityPolicy#" +
                                            std::string{name}));
        CHECK((policy == nullptr || policy->is_deprecated));
    }
    CHECK(known_rows().size() == (BUSBAR_LEGACY_POLICIES != 0 ? 5 : 3));
    CHECK(crypto::security_policies().size() == known_rows().size() + 1);
    for (const SecurityPolicy& policy : crypto::security_policies()) {
        CHECK(policy.is_deprecated == policy.allows_sha1_certificates);
    }
}

TEST_CASE("sizes and keys are those of Part 7 and of P_hash", "[crypto][policy]")
{
    for (const auto& [row, policy] : known_rows()) {
        INFO(row.name);
        CHECK(policy->symmetric_signature_size == row.signature_size);
        CHECK(policy->signing_key_size == row.signing_key_size);
        CHECK(policy->encrypting_key_size == row.encrypting_key_size);
        CHECK(policy->block_size == 16);
        CHECK(policy->nonce_size == row.nonce_size);
        CHECK(policy->min_key_bits == row.min_key_bits);
        CHECK(policy->max_key_bits == row.max_key_bits);
        const Bytes secret = random_bytes(row.nonce_size, 1);
        const Bytes seed = random_bytes(row.nonce_size, 2);
        const auto keys = crypto::derive_keys(*policy, secret, seed);
        REQUIRE(keys);
        Bytes all = copy_of(keys->signing_key.span());
        CHECK(all.size() == row.signing_key_size);
        all = joined(all, keys->encrypting_key.span());
        CHECK(all.size() == row.signing_key_size + row.encrypting_key_size);
        all = joined(all, keys->initialization_vector.span());
        CHECK(all == p_hash(row.digest(), secret, seed, all.size()));
    }
}

TEST_CASE("chunks are signed with the policy's HMAC", "[crypto][symmetric]")
{
    for (const auto& [row, policy] : known_rows()) {
        INFO(row.name);
        const auto keys = crypto::derive_keys(*policy, random_bytes(32), random_bytes(32, 2));
        REQUIRE(keys);
        auto cipher = crypto::SymmetricCipher::create(*policy, *keys);
        REQUIRE(cipher);
        const Bytes data = random_bytes(300);
        Bytes signature(row.signature_size);
        REQUIRE(cipher->sign(data, signature));
        CHECK(signature == hmac(row.digest(), keys->signing_key.span(), data));
        CHECK(cipher->verify(data, signature));
        Bytes longer = joined(signature, Bytes(1));
        CHECK_FALSE(cipher->verify(data, longer));
        CHECK_FALSE(cipher->sign(data, longer));
        CHECK_FALSE(cipher->verify(data, Bytes(64)));
        signature.back() ^= std::byte{1};
        CHECK_FALSE(cipher->verify(data, signature));
    }
}

TEST_CASE("RSA uses the policy's digests and paddings", "[crypto][asymmetric]")
{
    const Issued own = issue({}, key_number(1));
    EVP_PKEY* const native = own.key.native();
    const Bytes data = random_bytes(100);
    for (const auto& [row, policy] : known_rows()) {
        INFO(row.name);
        const auto signature = crypto::asymmetric_sign(*policy, own.key, data);
        REQUIRE(signature);
        if (policy->signature != crypto::AsymmetricSignature::PssSha256) {
            const crypto::detail::DigestContext context{EVP_MD_CTX_new()};
            REQUIRE(EVP_DigestVerifyInit(context.get(), nullptr, row.digest(), nullptr, native) ==
                    1);
            CHECK(EVP_DigestVerify(context.get(), crypto::detail::bytes_of(*signature),
                                   signature->size(), crypto::detail::bytes_of(data),
                                   data.size()) == 1);
        }
        const auto cipher = crypto::asymmetric_encrypt(*policy, own.certificate, data);
        REQUIRE(cipher);
        if (policy->encryption != crypto::AsymmetricEncryption::OaepSha256) {
            const crypto::detail::PkeyContext context{EVP_PKEY_CTX_new(native, nullptr)};
            Bytes text(256);
            std::size_t size = text.size();
            REQUIRE(EVP_PKEY_decrypt_init(context.get()) == 1);
            REQUIRE(EVP_PKEY_CTX_set_rsa_padding(context.get(), row.rsa_padding) == 1);
            REQUIRE(EVP_PKEY_decrypt(context.get(), crypto::detail::bytes_of(std::span{text}),
                                     &size, crypto::detail::bytes_of(*cipher),
                                     cipher->size()) == 1);
            text.resize(size);
            CHECK(text == data);
        }
    }
}

TEST_CASE("keys out of the policy's range sign and decrypt nothing", "[crypto][asymmetric]")
{
    const Bytes data = random_bytes(20);
    for (const std::uint32_t bits : {1016U, 1024U, 2048U, 2056U}) {
        const crypto::PrivateKey key = key_of(bits);
        const Issued issued = issue({}, key);
        for (const auto& [row, policy] : known_rows()) {
            INFO(row.name << " " << bits);
            const bool is_allowed = bits >= row.min_key_bits && bits <= row.max_key_bits;
            const auto signature = crypto::asymmetric_sign(*policy, key, data);
            const auto cipher = crypto::asymmetric_encrypt(*policy, issued.certificate, data);
            CHECK(signature.has_value() == is_allowed);
            CHECK(cipher.has_value() == is_allowed);
            CHECK(crypto::asymmetric_decrypt(*policy, key, Bytes(bits / 8)).has_value() ==
                  is_allowed);
            if (is_allowed) {
                CHECK(crypto::asymmetric_verify(*policy, issued.certificate, data, *signature));
            }
        }
    }
}

} // namespace legacy_policy_test
