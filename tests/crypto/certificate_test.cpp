#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/certificate_validator.hpp>

#include "hex.hpp"
#include "issuing.hpp"
#include "support/seeded_random.hpp"

namespace certificate_test {

using namespace busbar;
using namespace busbar::test;
using crypto::Certificate;
using crypto::parse_chain;

namespace {

const Issued& leaf()
{
    static const Issued made = issue({}, key_number(1));
    return made;
}

std::vector<std::byte> joined(std::initializer_list<const Certificate*> certificates)
{
    std::vector<std::byte> all;
    for (const Certificate* certificate : certificates) {
        all.insert(all.end(), certificate->der().begin(), certificate->der().end());
    }
    return all;
}

/// Everything that can be asked of a certificate whose bytes a stranger chose.
void ask_everything(const Certificate& certificate)
{
    CHECK(certificate.thumbprint().size() == 20);
    static_cast<void>(certificate.subject());
    static_cast<void>(certificate.application_uri());
    static_cast<void>(certificate.host_names());
    static_cast<void>(certificate.valid_from());
    static_cast<void>(certificate.valid_to());
    static_cast<void>(certificate.key_bits());
    static_cast<void>(crypto::check_certificate(
        certificate, {crypto::find_policy_by_name("Basic256Sha256"), now, "urn:x", "host"}));
}

} // namespace

TEST_CASE("a certificate tells what it says", "[crypto][certificate]")
{
    const Certificate& one = leaf().certificate;
    CHECK(one.subject() == "CN=leaf");
    CHECK(one.application_uri() == "urn:test:leaf");
    CHECK(one.host_names() == std::vector<std::string>{"plc.example", "192.0.2.7"});
    CHECK(one.valid_from() == in_days(-100));
    CHECK(one.valid_to() == in_days(100));
    CHECK(one.key_bits() == 2048);
    CHECK(one.key_size() == 256);
    CHECK(one.thumbprint_text().size() == 40);
    const auto again = Certificate::parse(one.der());
    REQUIRE(again);
    CHECK(*again == one);
    CHECK(again->thumbprint() == one.thumbprint());
    const auto from_pem = Certificate::parse_file(pem_of(one));
    REQUIRE(from_pem);
    CHECK(*from_pem == one);
    CHECK(*Certificate::parse_file(one.der()) == one);
}

TEST_CASE("an ApplicationUri is one whole URI, and the first one is shown", "[crypto][certificate]")
{
    const auto with = [](const std::string& names) {
        CertificateOptions options;
        options.names = names;
        return issue(options, key_number(1)).certificate;
    };
    const auto uri_with = [&](const std::string& names) { return with(names).application_uri(); };
    CHECK(uri_with("URI:urn:a") == "urn:a");
    CHECK(uri_with("DNS:host,URI:urn:a,IP:192.0.2.7") == "urn:a");
    CHECK(uri_with("URI:urn:a,URI:urn:b") == "urn:a");
    CHECK(uri_with("DNS:host").empty());
    CHECK(uri_with("").empty());
    const Certificate two = with("URI:urn:a,URI:urn:b");
    CHECK(two.uris() == std::vector<std::string>{"urn:a", "urn:b"});
    CHECK(two.is_of_application("urn:a"));
    CHECK(two.is_of_application("urn:b"));
    CHECK_FALSE(two.is_of_application("urn:"));
    CHECK_FALSE(two.is_of_application("urn:a,urn:b"));
    CHECK_FALSE(with("DNS:host").is_of_application(""));
}

TEST_CASE("a certificate cut anywhere is none", "[crypto][certificate][hostile]")
{
    const auto der = leaf().certificate.der();
    for (std::size_t size = 0; size < der.size(); ++size) {
        const auto cut = Certificate::parse(der.first(size));
        REQUIRE_FALSE(cut);
        CHECK(cut.error() == status::Bad_CertificateInvalid);
        CHECK_FALSE(parse_chain(der.first(size)));
    }
    auto longer = copy_of(der);
    longer.push_back(std::byte{0});
    CHECK_FALSE(Certificate::parse(longer));
}

TEST_CASE("flipped bits neither crash nor keep the certificate's identity",
          "[crypto][certificate][hostile]")
{
    const auto der = copy_of(leaf().certificate.der());
    for (std::size_t bit = 0; bit < der.size() * 8; ++bit) {
        auto changed = der;
        changed[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        static_cast<void>(parse_chain(changed));
        const auto parsed = Certificate::parse(changed);
        if (parsed && bit % 5 == 0) {
            CHECK_FALSE(*parsed == leaf().certificate);
            ask_everything(*parsed);
        }
    }
}

TEST_CASE("random bytes are no certificate", "[crypto][certificate][hostile]")
{
    SeededRandom random{9};
    for (int i = 0; i < 2'000; ++i) {
        std::vector<std::byte> bytes(1 + static_cast<std::size_t>(i) % 300);
        REQUIRE(random.fill(bytes));
        CHECK_FALSE(Certificate::parse(bytes));
        bytes.front() = std::byte{0x30};
        CHECK_FALSE(parse_chain(bytes));
        CHECK_FALSE(Certificate::parse_file(bytes));
    }
}

TEST_CASE("a chain is split where its certificates end", "[crypto][certificate]")
{
    const Issued root = issue(authority("root"), key_number(2));
    const Issued signed_leaf = issue({}, key_number(1), &root);
    const auto der = joined({&signed_leaf.certificate, &root.certificate});
    const auto chain = parse_chain(der);
    REQUIRE(chain);
    REQUIRE(chain->size() == 2);
    CHECK(chain->front() == signed_leaf.certificate);
    CHECK(chain->back() == root.certificate);
    for (std::size_t size = 0; size < der.size(); ++size) {
        const bool is_whole = size == signed_leaf.certificate.der().size();
        CHECK(parse_chain(std::span{der}.first(size)).has_value() == is_whole);
    }
}

TEST_CASE("a certificate that is known is not parsed once more", "[crypto][certificate]")
{
    const Issued root = issue(authority("root"), key_number(2));
    const Issued signed_leaf = issue({}, key_number(1), &root);
    const auto der = joined({&signed_leaf.certificate, &root.certificate});
    const auto chain = parse_chain(der, {&root.certificate, 1});
    REQUIRE(chain);
    CHECK(chain->front() == signed_leaf.certificate);
    CHECK(chain->front().native() != signed_leaf.certificate.native());
    CHECK(chain->back().native() == root.certificate.native());
    for (std::size_t size = 1; size < der.size(); ++size) {
        const bool is_whole = size == signed_leaf.certificate.der().size();
        CHECK(parse_chain(std::span{der}.first(size), *chain).has_value() == is_whole);
    }
}

TEST_CASE("the certificates that were kept last are known", "[crypto][certificate]")
{
    crypto::KnownCertificates known;
    std::vector<Certificate> all;
    for (std::size_t i = 0; i <= crypto::KnownCertificates::max_count; ++i) {
        all.push_back(issue({}, key_number(1)).certificate);
    }
    const auto knows = [&](const Certificate& certificate) {
        return std::ranges::count(known.certificates(), certificate) == 1;
    };
    const auto last = all.back();
    all.pop_back();
    known.keep(all);
    CHECK(std::ranges::all_of(all, knows));
    known.keep({all.front()}); // which is the newest now
    CHECK(std::ranges::all_of(all, knows));
    known.keep({last});
    CHECK(known.certificates().size() == crypto::KnownCertificates::max_count);
    CHECK((knows(last) && knows(all[0]) && !knows(all[1]) && knows(all[2])));
}

TEST_CASE("no large certificate is kept", "[crypto][certificate][hostile]")
{
    CertificateOptions options;
    options.extra = std::string(crypto::KnownCertificates::max_size, 'x');
    const Certificate large = issue(options, key_number(1)).certificate;
    REQUIRE(large.der().size() > crypto::KnownCertificates::max_size);
    crypto::KnownCertificates known;
    known.keep({large, leaf().certificate});
    REQUIRE(known.certificates().size() == 1);
    CHECK(known.certificates().front() == leaf().certificate);
}

TEST_CASE("chains are limited in length and size", "[crypto][certificate][hostile]")
{
    std::vector<std::byte> der;
    for (std::size_t i = 0; i < crypto::max_chain_length; ++i) {
        der.insert(der.end(), leaf().certificate.der().begin(), leaf().certificate.der().end());
    }
    CHECK(parse_chain(der));
    der.insert(der.end(), leaf().certificate.der().begin(), leaf().certificate.der().end());
    CHECK_FALSE(parse_chain(der));
    CHECK_FALSE(parse_chain({}));

    CHECK_FALSE(Certificate::parse(std::vector<std::byte>(1U << 20U, std::byte{0x30})));
}

TEST_CASE("DER lengths that wrap, lie or have no end are refused", "[crypto][certificate][hostile]")
{
    // tests/attacks.txt, C1.
    for (const char* head : {"3084fffffffa", "30847fffffff", "3088ffffffffffffffff", "3080",
                             "3085000000000a", "308400000000", "3083ffffff", "3082ffff", "30ff",
                             "30", "3000", "0500", "a003020102", "00000000"}) {
        INFO(head);
        auto der = from_hex(head);
        CHECK_FALSE(parse_chain(der));
        der.resize(2'000, std::byte{0x41});
        CHECK_FALSE(parse_chain(der));
        auto behind = copy_of(leaf().certificate.der());
        behind.insert(behind.end(), der.begin(), der.end());
        CHECK_FALSE(parse_chain(behind));
    }
}

TEST_CASE("keys that mean nothing are refused", "[crypto][certificate][hostile]")
{
    // tests/attacks.txt, C3.
    const std::string odd = random_modulus(2048, true);
    CHECK(Certificate::parse(der_with_public_key(odd, "10001")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(random_modulus(2048, false), "10001")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(odd, "01")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(odd, "10000")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(odd, "1" + std::string(16, '0') + "1")));
    CHECK_FALSE(Certificate::parse(der_with_public_key(random_modulus(16'400, true), "10001")));
}

TEST_CASE("names in certificates are data", "[crypto][certificate][hostile]")
{
    // tests/attacks.txt, G1: they never become file names; the thumbprint does.
    CertificateOptions options;
    options.common_name = std::string{"../../x\0y\n\x1b[2J", 14};
    const Issued odd = issue(options, key_number(1));
    CHECK(odd.certificate.subject().find('\n') == std::string::npos);
    CHECK(odd.certificate.thumbprint_text().find_first_not_of("0123456789ABCDEF") ==
          std::string::npos);
}

TEST_CASE("a chain that was read can be shared and outlives its bytes", "[crypto][certificate]")
{
    crypto::CertificateChain chain;
    {
        auto bytes = joined({&leaf().certificate});
        chain = *parse_chain(bytes);
        std::fill(bytes.begin(), bytes.end(), std::byte{});
    }
    const Certificate copy = chain.front();
    chain.clear();
    CHECK(copy == leaf().certificate);
}

} // namespace certificate_test
