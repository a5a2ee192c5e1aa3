#include <array>
#include <cstdint>

#include <catch2/catch.hpp>

#include <busbar/crypto/symmetric.hpp>

#include "hex.hpp"
#include "support/seeded_random.hpp"

namespace symmetric_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Secret;
using crypto::SecurityPolicy;
using crypto::SymmetricCipher;
using crypto::SymmetricKeys;

namespace {

std::vector<std::byte> random_bytes(std::size_t size, std::uint64_t seed = 1)
{
    SeededRandom random{seed};
    std::vector<std::byte> bytes(size);
    REQUIRE(random.fill(bytes));
    return bytes;
}

const SecurityPolicy& policy(std::string_view name)
{
    const auto* found = crypto::find_policy_by_name(name);
    REQUIRE(found != nullptr);
    return *found;
}

SymmetricCipher cipher_for(const SecurityPolicy& used, std::uint64_t seed = 1)
{
    auto keys = crypto::derive_keys(used, random_bytes(32, seed), random_bytes(32, seed + 100));
    REQUIRE(keys);
    auto cipher = SymmetricCipher::create(used, *keys);
    REQUIRE(cipher);
    return *std::move(cipher);
}

/// A cipher with keys of a published vector.
SymmetricCipher cipher_with(const char* signing, const char* encrypting, const char* vector)
{
    SymmetricKeys keys{Secret{from_hex(signing)}, Secret{from_hex(encrypting)},
                       Secret{from_hex(vector)}};
    SecurityPolicy used = policy("Basic256Sha256");
    used.signing_key_size = keys.signing_key.size();
    used.encrypting_key_size = keys.encrypting_key.size();
    auto cipher = SymmetricCipher::create(used, keys);
    REQUIRE(cipher);
    return *std::move(cipher);
}

constexpr const char* zero_block = "00000000000000000000000000000000";

} // namespace

TEST_CASE("the policies are what Part 7 says",
          "[crypto][policy][unit:Aes128-Sha256-RsaOaep_Limits]"
          "[unit:Aes256-Sha256-RsaPss_Limits][unit:Basic256Sha256_Limits]"
          "[unit:SecurtyPolicy_None_Limits]")
{
    CHECK(crypto::policy_none().is_none());
    CHECK(crypto::find_policy("http://opcfoundation.org/UA/SecurityPolicy#None") ==
          &crypto::policy_none());
    for (const char* name : {"Basic256Sha256", "Aes128_Sha256_RsaOaep", "Aes256_Sha256_RsaPss"}) {
        INFO(name);
        const SecurityPolicy& one = policy(name);
        CHECK(crypto::find_policy("http://opcfoundation.org/UA/SecurityPolicy#" +
                                  std::string{name}) == &one);
        CHECK(one.min_key_bits == 2048);
        CHECK(one.max_key_bits == 4096);
        CHECK(one.nonce_size == 32);
        CHECK(one.signing_key_size == 32);
        CHECK(one.symmetric_signature_size == 32);
        CHECK(one.block_size == 16);
        CHECK_FALSE(one.is_deprecated);
        CHECK_FALSE(one.allows_sha1_certificates);
    }
    CHECK(policy("Aes128_Sha256_RsaOaep").encrypting_key_size == 16);
    CHECK(policy("Basic256Sha256").encrypting_key_size == 32);
    CHECK(policy("Aes256_Sha256_RsaPss").signature_uri ==
          "http://opcfoundation.org/UA/security/rsa-pss-sha2-256");
    CHECK(crypto::find_policy("") == nullptr);
    CHECK(crypto::find_policy("http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha25") ==
          nullptr);
    CHECK(crypto::find_policy("http://opcfoundation.org/UA/SecurityPolicy#none") == nullptr);
}

TEST_CASE("keys are derived with P_SHA256",
          "[crypto][symmetric][unit:KeyDerivationAlgorithm_P-SHA2-256]")
{
    // The TLS working group's vector for P_SHA256 (list message 03416); its label belongs to the
    // seed here.
    const auto secret = from_hex("9bbe436ba940f017b17652849a71db35");
    auto seed = from_text("test label");
    for (const std::byte byte : from_hex("a0ba9f936cda311827a6f796ffd5198c")) {
        seed.push_back(byte);
    }
    const auto keys = crypto::derive_keys(policy("Basic256Sha256"), secret, seed);
    REQUIRE(keys);
    CHECK(copy_of(keys->signing_key.span()) ==
          from_hex("e3f229ba727be17b8d122620557cd453c2aab21d07c3d495329b52d4e61edb5a"));
    CHECK(copy_of(keys->encrypting_key.span()) ==
          from_hex("6b301791e90d35c9c9a46b4e14baf9af0fa022f7077def17abfd3797c0564bab"));
    CHECK(copy_of(keys->initialization_vector.span()) ==
          from_hex("4fbc91666e9def9b97fce34f796789ba"));

    const auto shorter = crypto::derive_keys(policy("Aes128_Sha256_RsaOaep"), secret, seed);
    REQUIRE(shorter);
    CHECK(copy_of(shorter->encrypting_key.span()) == from_hex("6b301791e90d35c9c9a46b4e14baf9af"));
    CHECK(copy_of(shorter->initialization_vector.span()) ==
          from_hex("0fa022f7077def17abfd3797c0564bab"));
}

TEST_CASE("without a secret there are no keys",
          "[crypto][symmetric][unit:KeyDerivationAlgorithm_None]"
          "[unit:SymmetricEncryptionAlgorithm_None]"
          "[unit:SymmetricSignatureAlgorithm_None]")
{
    const auto nonce = random_bytes(32);
    CHECK_FALSE(crypto::derive_keys(policy("Basic256Sha256"), {}, nonce));
    CHECK_FALSE(crypto::derive_keys(crypto::policy_none(), nonce, nonce));
    CHECK_FALSE(SymmetricCipher::create(crypto::policy_none(), SymmetricKeys{}));
    CHECK_FALSE(SymmetricCipher::create(policy("Basic256Sha256"), SymmetricKeys{}));
    const auto keys = crypto::derive_keys(policy("Aes128_Sha256_RsaOaep"), nonce, nonce);
    REQUIRE(keys);
    CHECK_FALSE(SymmetricCipher::create(policy("Basic256Sha256"), *keys));
}

TEST_CASE("AES-CBC as in NIST SP 800-38A",
          "[crypto][symmetric][unit:SymmetricEncryptionAlgorithm_AES128-CBC]"
          "[unit:SymmetricEncryptionAlgorithm_AES256-CBC]")
{
    constexpr const char* vector = "000102030405060708090a0b0c0d0e0f";
    constexpr const char* plain =
        "6bc1bee22e409f96e93d7e117393172aae2d8a571e03ac9c9eb76fac45af8e51"
        "30c81c46a35ce411e5fbc1191a0a52eff69f2445df4f9b17ad2b417be66c3710";
    struct Row {
        const char* key;
        const char* cipher;
    };
    constexpr std::array rows = {
        Row{"2b7e151628aed2a6abf7158809cf4f3c", // F.2.1
            "7649abac8119b246cee98e9b12e9197d5086cb9b507219ee95db113a917678b2"
            "73bed6b8e3c1743b7116e69e222295163ff1caa1681fac09120eca307586e1a7"},
        Row{"603deb1015ca71be2b73aef0857d77811f352c073b6108d72d9810a30914dff4", // F.2.5
            "f58c4c04d6e5f1ba779eabfb5f7bfbd69cfc4e967edb808d679f777bc6702c7d"
            "39f23369a9d9bacfa530e26304231461b2eb05e2c39be9fcda6c19078c6a9d1b"}};
    for (const Row& row : rows) {
        auto cipher = cipher_with("0b0b0b0b", row.key, vector);
        auto data = from_hex(plain);
        for (int round = 0; round < 3; ++round) { // every chunk begins with the same vector
            REQUIRE(cipher.encrypt(data));
            CHECK(data == from_hex(row.cipher));
            REQUIRE(cipher.decrypt(data));
            CHECK(data == from_hex(plain));
        }
    }
}

TEST_CASE("HMAC-SHA256 as in RFC 4231",
          "[crypto][symmetric][unit:SymmetricSignatureAlgorithm_HMAC-SHA2-256]")
{
    struct Row {
        std::string key;
        std::vector<std::byte> data;
        const char* signature;
    };
    const auto repeat = [](const char* text, std::size_t count) {
        std::string all;
        for (std::size_t i = 0; i < count; ++i) {
            all += text;
        }
        return all;
    };
    const std::array rows = {
        Row{repeat("0b", 20), from_text("Hi There"),
            "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7"},
        Row{"4a656665", from_text("what do ya want for nothing?"),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843"},
        Row{repeat("aa", 20), from_hex(repeat("dd", 50)),
            "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe"},
        Row{repeat("aa", 131), from_text("Test Using Larger Than Block-Size Key - Hash Key First"),
            "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54"}};
    for (const Row& row : rows) {
        auto cipher = cipher_with(row.key.c_str(), zero_block, zero_block);
        std::array<std::byte, 32> signature{};
        for (int round = 0; round < 3; ++round) {
            signature = {};
            REQUIRE(cipher.sign(row.data, signature));
            CHECK(copy_of(signature) == from_hex(row.signature));
            CHECK(cipher.verify(row.data, signature));
        }
    }
}

TEST_CASE("what was changed anywhere is not verified", "[crypto][symmetric]")
{
    auto cipher = cipher_for(policy("Basic256Sha256"));
    auto data = random_bytes(97);
    std::array<std::byte, 32> signature{};
    REQUIRE(cipher.sign(data, signature));
    for (std::size_t bit = 0; bit < data.size() * 8; ++bit) {
        data[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        CHECK_FALSE(cipher.verify(data, signature));
        data[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    }
    for (std::size_t bit = 0; bit < signature.size() * 8; ++bit) {
        signature[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        CHECK_FALSE(cipher.verify(data, signature));
        signature[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    }
    CHECK(cipher.verify(data, signature));
    for (std::size_t size = 0; size < signature.size(); ++size) {
        CHECK_FALSE(cipher.verify(data, std::span{signature}.first(size)));
    }
    CHECK_FALSE(cipher_for(policy("Basic256Sha256"), 2).verify(data, signature));
    std::array<std::byte, 31> too_short{};
    CHECK_FALSE(cipher.sign(data, too_short));
    CHECK(cipher.verify(data, signature)); // a refusal leaves no trace
}

TEST_CASE("every policy encrypts and decrypts in place", "[crypto][symmetric]")
{
    for (const SecurityPolicy& used : crypto::security_policies().subspan(1)) {
        INFO(used.name);
        auto sender = cipher_for(used);
        auto receiver = cipher_for(used);
        for (const std::size_t size : {std::size_t{16}, std::size_t{8'192}, std::size_t{65'520}}) {
            const auto plain = random_bytes(size, size);
            auto data = plain;
            REQUIRE(sender.encrypt(data));
            CHECK(data != plain);
            REQUIRE(receiver.decrypt(data));
            CHECK(data == plain);
        }
        auto odd = random_bytes(33);
        const auto before = odd;
        CHECK_FALSE(sender.encrypt(odd));
        CHECK_FALSE(receiver.decrypt(odd));
        CHECK(odd == before);
    }
}

TEST_CASE("a cipher that moved still works", "[crypto][symmetric]")
{
    auto first = cipher_for(policy("Basic256Sha256"));
    auto data = random_bytes(64);
    const auto plain = data;
    REQUIRE(first.encrypt(data));
    SymmetricCipher second{std::move(first)};
    REQUIRE(second.decrypt(data));
    CHECK(data == plain);
}

} // namespace symmetric_test
