#include <catch2/catch.hpp>

#include <busbar/crypto/asymmetric.hpp>

#include "hex.hpp"
#include "issuing.hpp"
#include "status_text.hpp"
#include "support/seeded_random.hpp"

namespace asymmetric_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Bytes;
using crypto::SecurityPolicy;

namespace {

const SecurityPolicy& policy(std::string_view name)
{
    return *crypto::find_policy_by_name(name);
}

Bytes random_bytes(std::size_t size, std::uint64_t seed = 1)
{
    SeededRandom random{seed};
    Bytes bytes(size);
    REQUIRE(random.fill(bytes));
    return bytes;
}

const Issued& own(std::uint32_t bits = 2048)
{
    static const Issued small = issue({}, key_number(1, 2048));
    static const Issued large = issue({}, key_number(1, 3072));
    return bits == 2048 ? small : large;
}

Bytes with_length(std::uint32_t length, const Bytes& rest)
{
    Bytes bytes;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<std::byte>(length >> shift));
    }
    bytes.insert(bytes.end(), rest.begin(), rest.end());
    return bytes;
}

template <typename T>
StatusCode error_of(const Result<T>& result)
{
    return result ? StatusCode{} : result.error();
}

} // namespace

TEST_CASE("blocks are as long as Part 6 and RFC 8017 make them", "[crypto][asymmetric]")
{
    CHECK(crypto::plain_block_size(policy("Basic256Sha256"), 256) == 214);
    CHECK(crypto::plain_block_size(policy("Aes128_Sha256_RsaOaep"), 512) == 470);
    CHECK(crypto::plain_block_size(policy("Aes256_Sha256_RsaPss"), 256) == 190);
    CHECK(crypto::plain_block_size(policy("Aes256_Sha256_RsaPss"), 66) == 0);
    CHECK(crypto::plain_block_size(policy("Basic256Sha256"), 0) == 0);
}

TEST_CASE("every policy signs, and every changed byte shows",
          "[crypto][asymmetric]"
          "[unit:AsymmetricSignatureAlgorithm_RSA-PKCS15-SHA2-256]"
          "[unit:AsymmetricSignatureAlgorithm_RSA-PSS-SHA2-256]")
{
    for (const SecurityPolicy& used : crypto::security_policies().subspan(1)) {
        INFO(used.name);
        auto data = random_bytes(50);
        const auto signature = crypto::asymmetric_sign(used, own().key, data);
        REQUIRE(signature);
        CHECK(signature->size() == 256);
        CHECK(crypto::asymmetric_verify(used, own().certificate, data, *signature));
        for (std::size_t at = 0; at < signature->size(); ++at) {
            Bytes changed = *signature;
            changed[at] ^= std::byte{0x40};
            CHECK(error_of(crypto::asymmetric_verify(used, own().certificate, data, changed)) ==
                  status::Bad_SecurityChecksFailed);
        }
        for (std::byte& byte : data) {
            byte ^= std::byte{1};
            CHECK_FALSE(crypto::asymmetric_verify(used, own().certificate, data, *signature));
            byte ^= std::byte{1};
        }
        for (const std::size_t size : {std::size_t{0}, std::size_t{255}}) {
            CHECK_FALSE(crypto::asymmetric_verify(used, own().certificate, data,
                                                  std::span{*signature}.first(size)));
        }
        const Issued stranger = issue({}, key_number(2));
        CHECK_FALSE(crypto::asymmetric_verify(used, stranger.certificate, data, *signature));
    }
}

TEST_CASE("one policy's signature is not another's", "[crypto][asymmetric]")
{
    const auto data = random_bytes(50);
    const auto pkcs1 = crypto::asymmetric_sign(policy("Basic256Sha256"), own().key, data);
    const auto pss = crypto::asymmetric_sign(policy("Aes256_Sha256_RsaPss"), own().key, data);
    REQUIRE((pkcs1 && pss));
    CHECK_FALSE(
        crypto::asymmetric_verify(policy("Aes256_Sha256_RsaPss"), own().certificate, data, *pkcs1));
    CHECK_FALSE(crypto::asymmetric_verify(policy("Basic256Sha256"), own().certificate, data, *pss));
}

TEST_CASE("texts of every length go through blocks and back",
          "[crypto][asymmetric][unit:AsymmetricEncryptionAlgorithm_RSA-OAEP-SHA1]"
          "[unit:AsymmetricEncryptionAlgorithm_RSA-OAEP-SHA2-256]")
{
    for (const SecurityPolicy& used : crypto::security_policies().subspan(1)) {
        for (const std::uint32_t bits : {2048U, 3072U}) {
            if (bits > used.max_key_bits) {
                continue;
            }
            INFO(used.name << " " << bits);
            const std::size_t key_size = bits / 8;
            const std::size_t block = crypto::plain_block_size(used, key_size);
            for (const std::size_t size :
                 {std::size_t{1}, block - 1, block, block + 1, 3 * block, 3 * block + 7}) {
                const auto plain = random_bytes(size, size);
                const auto cipher = crypto::asymmetric_encrypt(used, own(bits).certificate, plain);
                REQUIRE(cipher);
                CHECK(cipher->size() == (size + block - 1) / block * key_size);
                const auto back = crypto::asymmetric_decrypt(used, own(bits).key, *cipher);
                REQUIRE(back);
                REQUIRE(back->size() == cipher->size() / key_size * block);
                CHECK(std::equal(plain.begin(), plain.end(), back->begin()));
            }
        }
    }
}

TEST_CASE("what does not decrypt comes out as chance", "[crypto][asymmetric]")
{
    for (const SecurityPolicy& used : crypto::security_policies().subspan(1)) {
        INFO(used.name);
        const std::size_t block = crypto::plain_block_size(used, 256);
        const Bytes plain = random_bytes(2 * block);
        const auto cipher = crypto::asymmetric_encrypt(used, own().certificate, plain);
        REQUIRE(cipher);
        const auto decrypted = [&](const Bytes& changed, const crypto::PrivateKey& key) {
            const auto text = crypto::asymmetric_decrypt(used, key, changed);
            REQUIRE(text);
            REQUIRE(text->size() == changed.size() / 256 * block);
            return *text;
        };
        for (std::size_t at = 0; at < cipher->size(); at += 11) {
            Bytes changed = *cipher;
            changed[at] ^= std::byte{1};
            const Bytes text = decrypted(changed, own().key);
            const bool is_first = at < 256;
            // The other block is as it was: all blocks are worked on.
            CHECK(std::equal(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(block),
                             plain.begin()) == !is_first);
            CHECK(std::equal(text.end() - static_cast<std::ptrdiff_t>(block), text.end(),
                             plain.end() - static_cast<std::ptrdiff_t>(block)) == is_first);
            CHECK(decrypted(changed, own().key) != text);
        }
        // Another key, numbers that are no cipher text at all.
        CHECK(decrypted(*cipher, key_number(2)) != plain);
        for (const std::byte filler : {std::byte{0}, std::byte{0xFF}}) {
            CHECK(decrypted(Bytes(256, filler), own().key) != Bytes(block));
        }
    }
}

TEST_CASE("another padding is chance, too", "[crypto][asymmetric]")
{
    const Bytes plain = random_bytes(100);
    for (const SecurityPolicy& sent : crypto::security_policies().subspan(1)) {
        for (const SecurityPolicy& expected : crypto::security_policies().subspan(1)) {
            const auto cipher = crypto::asymmetric_encrypt(sent, own().certificate, plain);
            REQUIRE(cipher);
            const auto text = crypto::asymmetric_decrypt(expected, own().key, *cipher);
            REQUIRE(text);
            CHECK(std::equal(plain.begin(), plain.end(), text->begin()) ==
                  (sent.encryption == expected.encryption));
        }
    }
}

TEST_CASE("a cipher text of the wrong size is no cipher text", "[crypto][asymmetric]")
{
    const SecurityPolicy& used = policy("Basic256Sha256");
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{255},
                                   std::size_t{257}, (crypto::max_cipher_blocks + 1) * 256}) {
        CHECK(error_of(crypto::asymmetric_decrypt(used, own().key, Bytes(size))) ==
              status::Bad_SecurityChecksFailed);
    }
}

TEST_CASE("a signature beyond the modulus is none", "[crypto][asymmetric]")
{
    for (const SecurityPolicy& used : crypto::security_policies().subspan(1)) {
        CHECK_FALSE(crypto::asymmetric_verify(used, own().certificate, random_bytes(20),
                                              Bytes(256, std::byte{0xFF})));
    }
}

TEST_CASE("policy None and keys out of the policy's range do nothing",
          "[crypto][asymmetric][unit:AsymmetricEncryptionAlgorithm_None]"
          "[unit:AsymmetricSignatureAlgorithm_None][unit:Basic256Sha256_Limits]")
{
    const auto data = random_bytes(20);
    const SecurityPolicy& none = crypto::policy_none();
    CHECK_FALSE(crypto::asymmetric_sign(none, own().key, data));
    CHECK_FALSE(crypto::asymmetric_verify(none, own().certificate, data, random_bytes(256)));
    CHECK_FALSE(crypto::asymmetric_encrypt(none, own().certificate, data));
    CHECK_FALSE(crypto::asymmetric_decrypt(none, own().key, random_bytes(256)));

    SecurityPolicy strict = policy("Basic256Sha256");
    const auto signature = crypto::asymmetric_sign(strict, own().key, data);
    strict.min_key_bits = 3072;
    CHECK_FALSE(crypto::asymmetric_sign(strict, own().key, data));
    CHECK_FALSE(crypto::asymmetric_verify(strict, own().certificate, data, *signature));
    CHECK_FALSE(crypto::asymmetric_encrypt(strict, own().certificate, data));
    CHECK_FALSE(crypto::asymmetric_decrypt(strict, own().key, random_bytes(256)));
    CHECK(crypto::asymmetric_sign(strict, own(3072).key, data));
}

TEST_CASE("a password travels with the session's nonce", "[crypto][secret]")
{
    const auto nonce = random_bytes(32, 7);
    for (const SecurityPolicy& used : crypto::security_policies().subspan(1)) {
        for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{64}}) {
            INFO(used.name << " " << size);
            const auto password = random_bytes(size);
            const auto cipher = crypto::encrypt_secret(used, own().certificate, password, nonce);
            REQUIRE(cipher);
            const auto back = crypto::decrypt_secret(used, own().key, *cipher, nonce);
            REQUIRE(back);
            CHECK(copy_of(back->span()) == password);
            // The same blob in another session.
            CHECK(error_of(crypto::decrypt_secret(used, own().key, *cipher, random_bytes(32, 8))) ==
                  status::Bad_SecurityChecksFailed);
        }
    }
}

TEST_CASE("a password's length and nonce are not believed", "[crypto][secret]")
{
    const SecurityPolicy& used = policy("Basic256Sha256");
    const auto nonce = random_bytes(32, 7);
    const auto decrypted = [&](std::uint32_t length, const Bytes& rest) {
        const auto cipher =
            crypto::asymmetric_encrypt(used, own().certificate, with_length(length, rest));
        REQUIRE(cipher);
        return crypto::decrypt_secret(used, own().key, *cipher, nonce);
    };
    Bytes text = from_text("secret");
    text.insert(text.end(), nonce.begin(), nonce.end());
    const auto real = static_cast<std::uint32_t>(text.size());
    CHECK(decrypted(real, text));
    for (const std::uint32_t length :
         {0U, 1U, 31U, 32U, real - 1, real + 1, 0x7FFF'FFFFU, 0xFFFF'FFFFU, 0xFFFF'FFFCU}) {
        INFO(length);
        CHECK(error_of(decrypted(length, text)) == status::Bad_SecurityChecksFailed);
    }
    // Some clients fill the last block with zeros behind the nonce.
    Bytes filled = text;
    filled.resize(100);
    const auto back = decrypted(real, filled);
    REQUIRE(back);
    CHECK(back->text() == "secret");
    // 65 bytes are more than the format is for.
    Bytes longer(65, std::byte{'a'});
    longer.insert(longer.end(), nonce.begin(), nonce.end());
    CHECK(error_of(decrypted(97, longer)) == status::Bad_SecurityChecksFailed);
    CHECK(error_of(crypto::encrypt_secret(used, own().certificate, Bytes(65), nonce)) ==
          status::Bad_SecurityChecksFailed);
    for (std::size_t size = 0; size < 4; ++size) {
        const auto cipher = crypto::asymmetric_encrypt(used, own().certificate, Bytes(size + 1));
        CHECK(error_of(crypto::decrypt_secret(used, own().key, *cipher, nonce)) ==
              status::Bad_SecurityChecksFailed);
    }
    CHECK_FALSE(crypto::decrypt_secret(used, own().key, {}, nonce));
}

TEST_CASE("a secret is not bound to a nonce that is none", "[crypto][secret]")
{
    const SecurityPolicy& used = policy("Basic256Sha256");
    CHECK_FALSE(crypto::encrypt_secret(used, own().certificate, from_text("x"), {}));
    CHECK_FALSE(crypto::encrypt_secret(used, own().certificate, from_text("x"), random_bytes(31)));
    const auto cipher =
        crypto::asymmetric_encrypt(used, own().certificate, with_length(6, from_text("secret")));
    REQUIRE(cipher);
    CHECK(error_of(crypto::decrypt_secret(used, own().key, *cipher, {})) ==
          status::Bad_SecurityChecksFailed);
}

} // namespace asymmetric_test
