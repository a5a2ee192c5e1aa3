#include <catch2/catch.hpp>

#include <busbar/crypto/signing_request.hpp>

#include <crypto/openssl.hpp>

#include "issuing.hpp"
#include "status_text.hpp"

namespace signing_request_test {

using namespace busbar;
using namespace busbar::test;
using crypto::CertificateSubject;
using crypto::create_self_signed;
using crypto::create_signing_request;
namespace detail = crypto::detail;

namespace {

CertificateSubject subject()
{
    return {.common_name = "Line 3",
            .organization = "Works",
            .organizational_unit = "Paint",
            .locality = "Graz",
            .state = "Styria",
            .country = "AT",
            .domain_component = "plc",
            .application_uri = "urn:line-3:busbar",
            .dns_names = {"line-3", "line-3.example"},
            .ip_addresses = {"192.0.2.7", "2001:db8::7"},
            .valid_from = now,
            .valid_days = 10};
}

using Request = std::unique_ptr<X509_REQ, detail::FreeWith<X509_REQ_free>>;

Request parse(const std::vector<std::byte>& der)
{
    const unsigned char* at = detail::bytes_of(std::span{der});
    Request request{d2i_X509_REQ(nullptr, &at, static_cast<long>(der.size()))};
    REQUIRE(request);
    REQUIRE(at == detail::bytes_of(std::span{der}) + der.size());
    return request;
}

std::string contents(const detail::Bio& bio)
{
    char* text = nullptr;
    const long size = BIO_get_mem_data(bio.get(), &text);
    return {text, static_cast<std::size_t>(size)};
}

std::string text_of(const X509_NAME* name)
{
    const detail::Bio bio{BIO_new(BIO_s_mem())};
    X509_NAME_print_ex(bio.get(), name, 0, XN_FLAG_RFC2253 & ~XN_FLAG_DN_REV);
    return contents(bio);
}

/// Of an extension, as OpenSSL prints it, "critical " before it.
std::string text_of(const STACK_OF(X509_EXTENSION) * extensions, int id)
{
    const int at = X509v3_get_ext_by_NID(extensions, id, -1);
    if (at < 0) {
        return "none";
    }
    X509_EXTENSION* extension = X509v3_get_ext(extensions, at);
    const detail::Bio bio{BIO_new(BIO_s_mem())};
    X509V3_EXT_print(bio.get(), extension, 0, 0);
    return (X509_EXTENSION_get_critical(extension) == 1 ? "critical " : "") + contents(bio);
}

constexpr const char* all_fields = "CN=Line 3,O=Works,OU=Paint,L=Graz,ST=Styria,C=AT,DC=plc";
constexpr const char* all_names =
    "URI:urn:line-3:busbar, DNS:line-3, DNS:line-3.example, IP Address:192.0.2.7, "
    "IP Address:2001:DB8:0:0:0:0:0:7";
constexpr const char* usages =
    "critical Digital Signature, Non Repudiation, Key Encipherment, Data Encipherment";

} // namespace

TEST_CASE("a request says what Part 6, 6.2.2 asks of a certificate", "[crypto][request]")
{
    for (const std::uint32_t bits : {2048U, 3072U}) {
        const auto& key = key_number(1, bits);
        const auto der = create_signing_request(key, subject());
        REQUIRE(der);
        const Request request = parse(*der);
        CHECK(X509_REQ_get_version(request.get()) == X509_REQ_VERSION_1);
        CHECK(text_of(X509_REQ_get_subject_name(request.get())) == all_fields);
        // Proof of possession: signed by the key that it asks for, with SHA-256.
        CHECK(X509_REQ_get_signature_nid(request.get()) == NID_sha256WithRSAEncryption);
        CHECK(X509_REQ_verify(request.get(), key.native()) == 1);
        CHECK(EVP_PKEY_eq(X509_REQ_get0_pubkey(request.get()), key.native()) == 1);

        auto* extensions = X509_REQ_get_extensions(request.get());
        REQUIRE(extensions != nullptr);
        CHECK(text_of(extensions, NID_subject_alt_name) == all_names);
        CHECK(text_of(extensions, NID_basic_constraints) == "critical CA:FALSE");
        CHECK(text_of(extensions, NID_key_usage) == usages);
        CHECK(text_of(extensions, NID_ext_key_usage) ==
              "TLS Web Server Authentication, TLS Web Client Authentication");
        sk_X509_EXTENSION_pop_free(extensions, X509_EXTENSION_free);
    }
}

TEST_CASE("a self-signed certificate has the same content and signs itself", "[crypto][request]")
{
    const auto made = create_self_signed(key_number(1), subject());
    REQUIRE(made);
    const X509* x509 = made->native();
    CHECK(X509_get_version(x509) == X509_VERSION_3);
    CHECK(X509_get_signature_nid(x509) == NID_sha256WithRSAEncryption);
    CHECK(text_of(X509_get_subject_name(x509)) == all_fields);
    CHECK(text_of(X509_get_issuer_name(x509)) == all_fields);
    const auto* extensions = X509_get0_extensions(x509);
    CHECK(text_of(extensions, NID_subject_alt_name) == all_names);
    CHECK(text_of(extensions, NID_basic_constraints) == "critical CA:FALSE");
    CHECK(text_of(extensions, NID_key_usage) == std::string{usages} + ", Certificate Sign");
    CHECK(text_of(extensions, NID_ext_key_usage) ==
          "TLS Web Server Authentication, TLS Web Client Authentication");
    // Both identify the certificate's own key.
    const std::string key_id = text_of(extensions, NID_subject_key_identifier);
    CHECK(key_id.size() == 20 * 3 - 1);
    CHECK(text_of(extensions, NID_authority_key_identifier) == key_id);
    // A serial number of 127 random bits (RFC 5280, 4.1.2.2).
    const auto again = create_self_signed(key_number(1), subject());
    CHECK(ASN1_STRING_length(X509_get0_serialNumber(x509)) == 16);
    CHECK(ASN1_INTEGER_cmp(X509_get0_serialNumber(x509), X509_get0_serialNumber(again->native())) !=
          0);
}

TEST_CASE("fields have the lengths of RFC 5280", "[crypto][request][hostile]")
{
    struct Limit {
        std::string CertificateSubject::*field;
        std::size_t longest;
    };
    for (const auto& [field, longest] :
         {Limit{&CertificateSubject::common_name, 64}, Limit{&CertificateSubject::organization, 64},
          Limit{&CertificateSubject::organizational_unit, 64},
          Limit{&CertificateSubject::locality, 128}, Limit{&CertificateSubject::state, 128},
          Limit{&CertificateSubject::country, 2}}) {
        CertificateSubject wanted = subject();
        wanted.*field = std::string(longest, 'x');
        CHECK(create_signing_request(key_number(1), wanted));
        CHECK(create_self_signed(key_number(1), wanted));
        wanted.*field = std::string(longest + 1, 'x');
        CHECK(create_signing_request(key_number(1), wanted).error() == status::Bad_InvalidArgument);
        CHECK(create_self_signed(key_number(1), wanted).error() == status::Bad_InvalidArgument);
    }
    CertificateSubject wanted = subject();
    wanted.country = "A";
    CHECK_FALSE(create_signing_request(key_number(1), wanted));
    wanted = subject();
    wanted.organization = "\xC8";
    CHECK_FALSE(create_signing_request(key_number(1), wanted));
}

TEST_CASE("what cannot stand in a request is refused", "[crypto][request][hostile]")
{
    const auto refuses = [](auto change) {
        CertificateSubject wrong = subject();
        change(wrong);
        const auto made = create_signing_request(key_number(1), wrong);
        return !made && made.error() == status::Bad_InvalidArgument;
    };
    CHECK(refuses([](auto& s) { s.common_name.clear(); }));
    CHECK(refuses([](auto& s) { s.application_uri.clear(); }));
    CHECK(refuses([](auto& s) { s.application_uri = "urn:a,DNS:evil"; }));
    CHECK(refuses([](auto& s) { s.dns_names = {"a,URI:urn:b"}; }));
    CHECK(refuses([](auto& s) { s.dns_names = {""}; }));
    CHECK(refuses([](auto& s) { s.ip_addresses = {"256.1.1.1"}; }));
}

} // namespace signing_request_test
