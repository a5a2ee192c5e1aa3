#include <functional>
#include <limits>

#include <catch2/catch.hpp>
#include <openssl/pem.h>
#include <openssl/pkcs12.h>
#include <openssl/rsa.h>

#include <busbar/crypto/pkcs12.hpp>

#include <crypto/openssl.hpp>

#include "hex.hpp"
#include "issuing.hpp"
#include "status_text.hpp"
#include "support/effort.hpp"

namespace pkcs12_test {

using namespace busbar;
using namespace busbar::test;
using crypto::read_pkcs12;
namespace detail = crypto::detail;

namespace {

using File = std::unique_ptr<PKCS12, detail::FreeWith<PKCS12_free>>;
using Bytes = std::vector<std::byte>;

constexpr const char* passphrase = "a pass phrase";
constexpr int days_of_work = std::numeric_limits<int>::max();

const Issued& ca()
{
    static const Issued result = issue(authority("CA"), key_number(9));
    return result;
}

const Issued& leaf()
{
    static const Issued result = issue({}, key_number(1), &ca());
    return result;
}

/// How a file is made. A cipher of -1 is none, as are iterations of -1 for the MAC.
struct Recipe {
    const char* secret{passphrase};
    int key_cipher{NID_aes_256_cbc};
    int certificate_cipher{NID_aes_256_cbc};
    int iterations{2'048};
    int mac_iterations{2'048};
    const Issued* owner{&leaf()};
    bool has_issuer{true};
    bool has_key{true};
    bool has_certificate{true};
};

File make_file(const Recipe& recipe)
{
    STACK_OF(X509)* issuers = sk_X509_new_null();
    if (recipe.has_issuer) {
        sk_X509_push(issuers, ca().certificate.native());
    }
    File file{PKCS12_create(
        recipe.secret, nullptr, recipe.has_key ? recipe.owner->key.native() : nullptr,
        recipe.has_certificate ? recipe.owner->certificate.native() : nullptr, issuers,
        recipe.key_cipher, recipe.certificate_cipher, recipe.iterations, recipe.mac_iterations, 0)};
    sk_X509_free(issuers);
    REQUIRE(file);
    return file;
}

Bytes bytes_of(const File& file)
{
    unsigned char* der = nullptr;
    const int size = i2d_PKCS12(file.get(), &der);
    REQUIRE(size > 0);
    const auto bytes = std::as_bytes(std::span{der, static_cast<std::size_t>(size)});
    Bytes result{bytes.begin(), bytes.end()};
    OPENSSL_free(der);
    return result;
}

Bytes make(const Recipe& recipe)
{
    return bytes_of(make_file(recipe));
}

/// Changes the parts of a file, which has no MAC.
void change_parts(const File& file, const std::function<void(STACK_OF(PKCS7) *)>& change)
{
    STACK_OF(PKCS7)* parts = PKCS12_unpack_authsafes(file.get());
    REQUIRE(parts != nullptr);
    change(parts);
    REQUIRE(PKCS12_pack_authsafes(file.get(), parts) == 1);
    sk_PKCS7_pop_free(parts, PKCS7_free);
}

/// A key derivation that takes days.
X509_ALGOR* expensive_algorithm()
{
    X509_ALGOR* algorithm =
        PKCS5_pbe2_set_iv(EVP_aes_256_cbc(), days_of_work, nullptr, 0, nullptr, NID_hmacWithSHA256);
    REQUIRE(algorithm != nullptr);
    return algorithm;
}

void make_expensive(X509_ALGOR* algorithm)
{
    X509_ALGOR* expensive = expensive_algorithm();
    REQUIRE(X509_ALGOR_copy(algorithm, expensive) == 1);
    X509_ALGOR_free(expensive);
}

/// Of every encrypted part.
void make_parts_expensive(STACK_OF(PKCS7) * parts)
{
    for (int i = 0; i < sk_PKCS7_num(parts); ++i) {
        PKCS7* part = sk_PKCS7_value(parts, i);
        if (PKCS7_type_is_encrypted(part)) {
            make_expensive(part->d.encrypted->enc_data->algorithm);
        }
    }
}

/// Of the encrypted keys in parts that are not.
void make_keys_expensive(STACK_OF(PKCS7) * parts)
{
    for (int i = 0; i < sk_PKCS7_num(parts); ++i) {
        PKCS7* part = sk_PKCS7_value(parts, i);
        if (!PKCS7_type_is_data(part)) {
            continue;
        }
        STACK_OF(PKCS12_SAFEBAG)* bags = PKCS12_unpack_p7data(part);
        for (int k = 0; k < sk_PKCS12_SAFEBAG_num(bags); ++k) {
            const PKCS12_SAFEBAG* bag = sk_PKCS12_SAFEBAG_value(bags, k);
            if (PKCS12_SAFEBAG_get_nid(bag) == NID_pkcs8ShroudedKeyBag) {
                X509_ALGOR* algorithm = nullptr;
                X509_SIG_getm(const_cast<X509_SIG*>(PKCS12_SAFEBAG_get0_pkcs8(bag)), &algorithm,
                              nullptr);
                make_expensive(algorithm);
            }
        }
        PKCS7* changed = PKCS12_pack_p7data(bags);
        sk_PKCS12_SAFEBAG_pop_free(bags, PKCS12_SAFEBAG_free);
        PKCS7_free(part);
        sk_PKCS7_set(parts, i, changed);
    }
}

std::string refusal(std::span<const std::byte> contents, std::string_view with = passphrase,
                    const crypto::Pkcs12Limits& limits = {})
{
    const auto result = read_pkcs12(contents, with, limits);
    REQUIRE_FALSE(result);
    CHECK(result.error().status == status::Bad_ConfigurationError);
    return text(result.error());
}

bool says(const std::string& text, const std::string& part)
{
    INFO(text);
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("key, certificate and issuers come out of a PKCS#12 file", "[crypto][pkcs12]")
{
    const auto is_read = [](const Recipe& recipe) {
        const auto own = read_pkcs12(make(recipe), recipe.secret);
        return own && own->key.to_pem()->text() == leaf().key.to_pem()->text() &&
               own->certificates == crypto::CertificateChain{leaf().certificate, ca().certificate};
    };
    CHECK(is_read({}));
    for (const int cipher :
         {NID_aes_128_cbc, NID_aes_256_cbc, -1, NID_pbe_WithSHA1And3_Key_TripleDES_CBC}) {
        CHECK(is_read({.key_cipher = cipher, .certificate_cipher = cipher}));
    }
    CHECK(is_read({.mac_iterations = -1}));
    CHECK(is_read({.iterations = 1, .mac_iterations = 1}));
    // As many as are recommended take seconds.
    constexpr int recommended = 600'000;
    CHECK(crypto::Pkcs12Limits{}.max_iterations >= 3 * recommended);
    const int many = is_full_effort() ? recommended : recommended / 10;
    CHECK(is_read({.iterations = many, .mac_iterations = many}));
    CHECK(is_read({.secret = ""}));
    CHECK(is_read({.secret = "\xC3\xA4\xE2\x82\xAC"})); // UTF-8
}

TEST_CASE("an empty passphrase is understood in both ways", "[crypto][pkcs12]")
{
    // PKCS12_create makes a null one of a null pointer.
    Recipe recipe;
    recipe.secret = nullptr;
    CHECK(read_pkcs12(make(recipe), ""));
}

TEST_CASE("a file without issuers, or with others, gives what belongs to the key",
          "[crypto][pkcs12]")
{
    Recipe recipe;
    recipe.has_issuer = false;
    const auto alone = read_pkcs12(make(recipe), passphrase);
    REQUIRE(alone);
    CHECK(alone->certificates == crypto::CertificateChain{leaf().certificate});

    const Issued self_signed = issue({}, key_number(2));
    const Recipe others{.owner = &self_signed};
    const auto own = read_pkcs12(make(others), passphrase);
    REQUIRE(own);
    CHECK(own->certificates == crypto::CertificateChain{self_signed.certificate});
}

TEST_CASE("a wrong passphrase is told from a file that lacks something", "[crypto][pkcs12]")
{
    for (const char* wrong : {"", "another", "a pass phrase "}) {
        CHECK(says(refusal(make({}), wrong), "passphrase is wrong"));
        CHECK(says(refusal(make({.mac_iterations = -1}), wrong), "passphrase is wrong"));
    }
    CHECK(says(refusal(make({}), std::string(2'000, 'x')), "too long"));
    CHECK(says(refusal(make({.has_key = false, .has_certificate = false})), "no private key"));
    CHECK(says(refusal(make({.has_certificate = false})), "no certificate for its private key"));
    for (const auto& line : {refusal(make({}), "another"),
                             refusal(make({.has_key = false, .has_certificate = false}))}) {
        CHECK_FALSE(says(line, passphrase));
        CHECK_FALSE(says(line, "another"));
    }
}

TEST_CASE("a file must not have two keys, nor one that is not RSA", "[crypto][pkcs12][hostile]")
{
    const File file = make_file({.key_cipher = -1, .certificate_cipher = -1, .mac_iterations = -1});
    change_parts(file, [](STACK_OF(PKCS7) * parts) {
        const int size = sk_PKCS7_num(parts);
        for (int i = 0; i < size; ++i) {
            sk_PKCS7_push(parts, PKCS7_dup(sk_PKCS7_value(parts, i)));
        }
    });
    CHECK(says(refusal(bytes_of(file)), "more than one private key"));

    const detail::Pkey curve{EVP_EC_gen("P-256")};
    const File other{
        PKCS12_create(passphrase, nullptr, curve.get(), nullptr, nullptr, 0, 0, 1, 1, 0)};
    REQUIRE(other);
    CHECK(says(refusal(bytes_of(other)), "not an RSA key"));
}

TEST_CASE("a key derivation of days is refused before it begins", "[crypto][pkcs12][hostile]")
{
    SECTION("of the integrity check")
    {
        const File file = make_file({});
        const ASN1_INTEGER* iterations = nullptr;
        PKCS12_get0_mac(nullptr, nullptr, nullptr, &iterations, file.get());
        REQUIRE(ASN1_INTEGER_set(const_cast<ASN1_INTEGER*>(iterations), days_of_work) == 1);
        CHECK(says(refusal(bytes_of(file)), "2147483647 iterations"));
        REQUIRE(ASN1_INTEGER_set_int64(const_cast<ASN1_INTEGER*>(iterations), INT64_MAX) == 1);
        CHECK(says(refusal(bytes_of(file)), "iterations"));
        REQUIRE(ASN1_INTEGER_set(const_cast<ASN1_INTEGER*>(iterations), -1) == 1);
        CHECK(says(refusal(bytes_of(file)), "integrity check cannot be read"));
    }
    SECTION("of an encrypted part")
    {
        const File file = make_file({.mac_iterations = -1});
        change_parts(file, make_parts_expensive);
        CHECK(says(refusal(bytes_of(file)), "2147483647 iterations"));
    }
    SECTION("of the key")
    {
        const File file = make_file({.certificate_cipher = -1, .mac_iterations = -1});
        change_parts(file, make_keys_expensive);
        CHECK(says(refusal(bytes_of(file)), "2147483647 iterations"));
    }
    SECTION("of all together")
    {
        const Bytes file = make({.iterations = 4'000, .mac_iterations = 4'000});
        CHECK(read_pkcs12(file, passphrase, {.max_iterations = 12'000}));
        CHECK(says(refusal(file, passphrase, {.max_iterations = 11'999}), "4000 iterations"));
    }
}

TEST_CASE("an encrypted key file cannot ask for days either", "[crypto][key][hostile]")
{
    X509_ALGOR* algorithm = expensive_algorithm();
    X509_SIG* key = X509_SIG_new();
    X509_ALGOR* target = nullptr;
    ASN1_OCTET_STRING* data = nullptr;
    X509_SIG_getm(key, &target, &data);
    REQUIRE(X509_ALGOR_copy(target, algorithm) == 1);
    ASN1_OCTET_STRING_set(data, reinterpret_cast<const unsigned char*>("0123456789abcdef"), 16);
    const detail::Bio der{BIO_new(BIO_s_mem())};
    const detail::Bio pem{BIO_new(BIO_s_mem())};
    REQUIRE(i2d_PKCS8_bio(der.get(), key) == 1);
    REQUIRE(PEM_write_bio_PKCS8(pem.get(), key) == 1);
    X509_SIG_free(key);
    X509_ALGOR_free(algorithm);
    for (const auto& bio : {std::cref(der), std::cref(pem)}) {
        char* text = nullptr;
        const long size = BIO_get_mem_data(bio.get().get(), &text);
        const Bytes contents = from_text({text, static_cast<std::size_t>(size)});
        CHECK(crypto::PrivateKey::parse(contents, passphrase).error() ==
              status::Bad_ConfigurationError);
        // Nor behind something else.
        Bytes second = pem_of(ca().certificate);
        second.insert(second.end(), contents.begin(), contents.end());
        CHECK_FALSE(crypto::PrivateKey::parse(second, passphrase));
    }
}

TEST_CASE("a file has 16 parts at most", "[crypto][pkcs12][hostile]")
{
    const File file = make_file({.iterations = 1, .mac_iterations = -1});
    const auto fill_up_to = [&](int count) {
        change_parts(file, [&](STACK_OF(PKCS7) * parts) {
            STACK_OF(PKCS12_SAFEBAG)* nothing = sk_PKCS12_SAFEBAG_new_null();
            while (sk_PKCS7_num(parts) < count) {
                sk_PKCS7_push(parts, PKCS12_pack_p7data(nothing));
            }
            sk_PKCS12_SAFEBAG_free(nothing);
        });
    };
    fill_up_to(16);
    CHECK(read_pkcs12(bytes_of(file), passphrase));
    fill_up_to(17);
    CHECK(says(refusal(bytes_of(file)), "its list of contents"));
}

TEST_CASE("what is no PKCS#12 file is refused at every length", "[crypto][pkcs12][hostile]")
{
    const Bytes file = make({.iterations = 1, .mac_iterations = 1});
    for (std::size_t size = 0; size < file.size(); ++size) {
        CHECK_FALSE(read_pkcs12(std::span{file}.first(size), passphrase));
    }
    Bytes longer = file;
    longer.push_back(std::byte{0});
    CHECK(says(refusal(longer), "not a PKCS#12 file"));
    CHECK(says(refusal(Bytes(100'000)), "too long"));
    CHECK(says(refusal(pem_of(ca().certificate)), "not a PKCS#12 file"));
}

TEST_CASE("a damaged file is refused or gives the same", "[crypto][pkcs12][hostile]")
{
    // Without integrity check and encryption every byte is looked at. A fifth of them a day.
    const Bytes file = make({.key_cipher = -1, .certificate_cipher = -1, .mac_iterations = -1});
    const crypto::Pkcs12Limits limits{.max_iterations = 1'000};
    const Turns places{"damaged", 5};
    for (std::size_t at = places.first; at < file.size(); at += places.stride) {
        Bytes damaged = file;
        damaged[at] ^= at % 2 == 0 ? std::byte{0x01} : std::byte{0x80};
        const auto own = read_pkcs12(damaged, passphrase, limits);
        if (own) {
            CHECK(own->key.belongs_to(own->certificates.front()));
        }
    }
}

} // namespace pkcs12_test
