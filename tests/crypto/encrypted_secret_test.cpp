#include <catch2/catch.hpp>

#include <busbar/crypto/encrypted_secret.hpp>

#include "issuing.hpp"
#include "secret_maker.hpp"
#include "status_text.hpp"
#include "support/seeded_random.hpp"

namespace encrypted_secret_test {

/// RsaEncryptedSecret (Part 4, 7.40.2.4).
using namespace busbar;
using namespace busbar::test;
using crypto::Bytes;
using crypto::SecurityPolicy;

namespace {

constexpr std::size_t most = 256;

const Issued& receiver()
{
    static const Issued issued = issue({}, key_number(1));
    return issued;
}

const SecurityPolicy& basic()
{
    return *crypto::find_policy_by_name("Basic256Sha256");
}

Bytes bytes_of(std::size_t size, std::uint64_t seed = 1)
{
    SeededRandom random{seed};
    Bytes bytes(size);
    REQUIRE(random.fill(bytes));
    return bytes;
}

const Bytes& nonce()
{
    static const Bytes bytes = bytes_of(32, 7);
    return bytes;
}

Result<crypto::Secret> unseal(const SecurityPolicy& policy, std::span<const std::byte> sealed,
                              std::span<const std::byte> server_nonce = nonce())
{
    return crypto::unseal_secret(policy, receiver().certificate, receiver().key, sealed,
                                 server_nonce, most);
}

bool is_refused(const Result<crypto::Secret>& result)
{
    return !result && result.error() == status::Bad_SecurityChecksFailed;
}

bool is_refused(const SecretParts& parts)
{
    const auto sealed = make_secret(basic(), receiver().certificate, parts);
    REQUIRE(sealed);
    return is_refused(unseal(basic(), *sealed));
}

SecretParts right_parts()
{
    // 4 + 32 + 4 + 100 + 2 are 142 bytes, two fewer than nine blocks.
    return secret_parts(basic(), receiver().certificate, secret_payload(nonce(), bytes_of(100), 2));
}

} // namespace

TEST_CASE("a secret of any size comes back, and only with its session's nonce", "[crypto][secret]")
{
    for (const SecurityPolicy& policy : crypto::security_policies().subspan(1)) {
        for (const std::size_t size : {0U, 1U, 15U, 16U, 64U, 65U, 256U}) {
            INFO(policy.name << " " << size);
            const Bytes secret = bytes_of(size);
            const auto sealed =
                crypto::seal_secret(policy, receiver().certificate, secret, nonce(), now);
            REQUIRE(sealed);
            CHECK(crypto::is_encrypted_secret(*sealed));
            const auto back = unseal(policy, *sealed);
            REQUIRE(back);
            CHECK(std::ranges::equal(back->span(), secret));
            CHECK(is_refused(unseal(policy, *sealed, bytes_of(32, 8))));
            CHECK(is_refused(unseal(policy, *sealed, {})));
        }
        const auto longer =
            crypto::seal_secret(policy, receiver().certificate, Bytes(most + 1), nonce(), now);
        REQUIRE(longer);
        CHECK(is_refused(unseal(policy, *longer)));
    }
}

TEST_CASE("the size of a short secret does not show", "[crypto][secret]")
{
    const auto size_of = [](std::size_t size) {
        return crypto::seal_secret(basic(), receiver().certificate, Bytes(size), nonce(), now)
            .value()
            .size();
    };
    // 42 bytes of nonce and sizes: two blocks for all that fits into what is left of them.
    for (std::size_t size = 0; size <= 6; ++size) {
        CHECK(size_of(size) == size_of(0));
    }
}

TEST_CASE("secrets are read that were put together from the fields of the specification",
          "[crypto][secret]")
{
    for (const SecurityPolicy& policy : crypto::security_policies().subspan(1)) {
        // With as little padding as there may be, and with a block more.
        for (const std::size_t padding : {2U, 18U}) {
            INFO(policy.name << " " << padding);
            const auto sealed =
                make_secret(policy, receiver().certificate,
                            secret_parts(policy, receiver().certificate,
                                         secret_payload(nonce(), bytes_of(100), padding)));
            REQUIRE(sealed);
            const auto back = unseal(policy, *sealed);
            REQUIRE(back);
            CHECK(std::ranges::equal(back->span(), bytes_of(100)));
        }
    }
}

TEST_CASE("every changed byte of an encrypted secret is noticed", "[crypto][secret]")
{
    const auto sealed =
        crypto::seal_secret(basic(), receiver().certificate, bytes_of(70), nonce(), now);
    REQUIRE(sealed);
    for (std::size_t i = 0; i < sealed->size(); ++i) {
        INFO(i);
        Bytes changed = *sealed;
        changed[i] ^= std::byte{0x10};
        CHECK(is_refused(unseal(basic(), changed)));
    }
    for (std::size_t size = 0; size < sealed->size(); ++size) {
        CHECK(is_refused(unseal(basic(), std::span{*sealed}.first(size))));
    }
    Bytes longer = *sealed;
    longer.push_back(std::byte{0});
    CHECK(is_refused(unseal(basic(), longer)));
}

TEST_CASE("what an encrypted secret says of itself is not believed", "[crypto][secret]")
{
    REQUIRE(unseal(basic(), make_secret(basic(), receiver().certificate, right_parts()).value()));
    SecretParts parts = right_parts();
    SECTION("other types")
    {
        parts.is_long = GENERATE(false, true);
        parts.type = 17'546; // EccEncryptedSecret
        CHECK(is_refused(parts));
        parts.type = 17'545;
        parts.mask = 2;
        CHECK(is_refused(parts));
        parts.mask = 1;
        CHECK_FALSE(is_refused(parts));
    }
    SECTION("lengths")
    {
        for (const std::uint64_t length : {0ULL, 1ULL, 0x7FFF'FFFFULL, 0xFFFF'FFFFULL}) {
            parts.length = length;
            CHECK(is_refused(parts));
        }
    }
    SECTION("another policy's name, another certificate's thumbprint")
    {
        parts.uri = crypto::find_policy_by_name("Aes128_Sha256_RsaOaep")->uri;
        CHECK(is_refused(parts));
        parts = right_parts();
        parts.thumbprint = issue({}, key_number(2)).certificate.thumbprint();
        CHECK(is_refused(parts));
        parts.thumbprint.clear();
        CHECK(is_refused(parts));
    }
    SECTION("keys of other sizes")
    {
        for (Bytes* const key :
             {&parts.signing_key, &parts.encrypting_key, &parts.initialization_vector}) {
            const Bytes kept = *key;
            for (const std::size_t size : {std::size_t{0}, kept.size() - 1, kept.size() + 1}) {
                key->resize(size);
                CHECK(is_refused(parts));
            }
            *key = kept;
        }
    }
    SECTION("paddings")
    {
        parts.payload = secret_payload(nonce(), bytes_of(100), 2);
        parts.payload[parts.payload.size() - 3] = std::byte{3}; // not all the same
        CHECK(is_refused(parts));
        for (const unsigned size : {0U, 1U, 3U, 18U, 0xFF02U}) {
            parts.payload = secret_payload(nonce(), bytes_of(100), 2);
            parts.payload[parts.payload.size() - 2] = static_cast<std::byte>(size);
            parts.payload[parts.payload.size() - 1] = static_cast<std::byte>(size >> 8);
            CHECK(is_refused(parts));
        }
    }
    SECTION("nonces and secrets that end behind the payload")
    {
        for (const std::size_t place : {std::size_t{0}, 4 + nonce().size()}) {
            for (const int length : {0x00, 0x1F, 0x21, 0x7F, 0xFF}) {
                parts.payload = secret_payload(nonce(), bytes_of(100), 2);
                parts.payload[place] = static_cast<std::byte>(length);
                parts.payload[place + 3] = static_cast<std::byte>(length & 0xF0);
                CHECK(is_refused(parts));
            }
        }
        parts.payload = Bytes(16);
        CHECK(is_refused(parts));
    }
}

TEST_CASE("an encrypted secret needs a policy and a nonce", "[crypto][secret]")
{
    const Bytes secret = bytes_of(10);
    const auto& certificate = receiver().certificate;
    CHECK_FALSE(crypto::seal_secret(crypto::policy_none(), certificate, secret, nonce(), now));
    CHECK_FALSE(crypto::seal_secret(basic(), certificate, secret, bytes_of(31), now));
    const auto sealed = crypto::seal_secret(basic(), certificate, secret, nonce(), now);
    REQUIRE(sealed);
    CHECK(is_refused(unseal(crypto::policy_none(), *sealed)));
    CHECK(is_refused(unseal(*crypto::find_policy_by_name("Aes256_Sha256_RsaPss"), *sealed)));
    // For another receiver's key.
    CHECK(is_refused(
        crypto::unseal_secret(basic(), certificate, key_number(2), *sealed, nonce(), most)));
    CHECK_FALSE(crypto::is_encrypted_secret({}));
    CHECK_FALSE(crypto::is_encrypted_secret(Bytes(256)));
}

} // namespace encrypted_secret_test
