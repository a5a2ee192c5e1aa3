#include <busbar/crypto/self_signed.hpp>

#include <openssl/err.h>
#include <openssl/rand.h>

#include <array>

#include "certificate_content.hpp"

namespace busbar::crypto {

namespace {

bool add_extension(X509* certificate, int id, const std::string& value)
{
    X509V3_CTX context;
    X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
    const detail::Extension extension = detail::make_extension(context, id, value);
    return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

/// Part 6, 6.2.2: not a CA, but keyCertSign, since the key signs the certificate itself.
bool add_extensions(X509* certificate, const std::string& names)
{
    return add_extension(certificate, NID_basic_constraints, detail::basic_constraints) &&
           add_extension(certificate, NID_subject_key_identifier, "hash") &&
           add_extension(certificate, NID_authority_key_identifier, "keyid:always") &&
           add_extension(certificate, NID_key_usage,
                         std::string{detail::key_usage} + ",keyCertSign") &&
           add_extension(certificate, NID_ext_key_usage, detail::extended_key_usage) &&
           add_extension(certificate, NID_subject_alt_name, names);
}

bool set_serial(X509* certificate)
{
    std::array<unsigned char, 16> bytes{};
    if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
        return false;
    }
    bytes[0] = static_cast<unsigned char>((bytes[0] & 0x7FU) | 0x40U); // positive, full length
    BIGNUM* number = BN_bin2bn(bytes.data(), static_cast<int>(bytes.size()), nullptr);
    const bool is_set = number != nullptr &&
                        BN_to_ASN1_INTEGER(number, X509_get_serialNumber(certificate)) != nullptr;
    BN_free(number);
    return is_set;
}

constexpr std::int64_t seconds_per_day = 86'400;

/// Valid up to the last moment that a certificate can express (RFC 5280, 4.1.2.5).
bool has_validity(const CertificateSubject& subject)
{
    constexpr std::int64_t latest = DateTime{DateTime::latest}.unix_seconds();
    const std::int64_t seconds = std::int64_t{subject.valid_days} * seconds_per_day;
    return seconds != 0 && !subject.valid_from.is_null() &&
           subject.valid_from.unix_seconds() <= latest - seconds;
}

bool set_validity(X509* certificate, const CertificateSubject& subject)
{
    const DateTime from = subject.valid_from;
    const DateTime to{from.ticks + std::int64_t{subject.valid_days} * seconds_per_day *
                                       DateTime::ticks_per_second};
    return detail::set_time(X509_getm_notBefore(certificate), from) &&
           detail::set_time(X509_getm_notAfter(certificate), to);
}

bool fill(X509* certificate, const PrivateKey& key, const CertificateSubject& subject,
          const std::string& names)
{
    X509_NAME* name = X509_get_subject_name(certificate);
    return X509_set_version(certificate, X509_VERSION_3) == 1 && set_serial(certificate) &&
           set_validity(certificate, subject) && detail::add_fields(name, subject) &&
           X509_set_issuer_name(certificate, name) == 1 &&
           X509_set_pubkey(certificate, key.native()) == 1 && add_extensions(certificate, names) &&
           X509_sign(certificate, key.native(), EVP_sha256()) > 0;
}

std::string field_of(const X509* certificate, int id)
{
    const X509_NAME* const name = X509_get_subject_name(certificate);
    const int place = X509_NAME_get_index_by_NID(name, id, -1);
    if (place < 0) {
        return {};
    }
    unsigned char* text = nullptr;
    const int size =
        ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(name, place)));
    std::string result{reinterpret_cast<const char*>(text),
                       size > 0 ? static_cast<std::size_t>(size) : 0};
    OPENSSL_free(text);
    return result;
}

} // namespace

CertificateSubject subject_of(const Certificate& certificate)
{
    const X509* const x509 = certificate.native();
    CertificateSubject subject;
    subject.common_name = field_of(x509, NID_commonName);
    subject.organization = field_of(x509, NID_organizationName);
    subject.organizational_unit = field_of(x509, NID_organizationalUnitName);
    subject.locality = field_of(x509, NID_localityName);
    subject.state = field_of(x509, NID_stateOrProvinceName);
    subject.country = field_of(x509, NID_countryName);
    subject.domain_component = field_of(x509, NID_domainComponent);
    subject.application_uri = certificate.application_uri();
    for (const std::string& host : certificate.host_names()) {
        add_host(subject, host);
    }
    return subject;
}

void add_host(CertificateSubject& subject, const std::string& host)
{
    // A host name does not end in a number (RFC 1123, 2.1) or contain a colon.
    const bool is_address = host.find(':') != std::string::npos ||
                            host.find_first_not_of("0123456789.") == std::string::npos;
    (is_address ? subject.ip_addresses : subject.dns_names).push_back(host);
}

Result<Certificate> create_self_signed(const PrivateKey& key, const CertificateSubject& subject)
{
    const auto names = detail::alternative_names(subject);
    if (!names || !has_validity(subject)) {
        return fail(status::Bad_InvalidArgument);
    }
    const detail::X509Pointer x509{X509_new()};
    unsigned char* der = nullptr;
    const int size =
        x509 && fill(x509.get(), key, subject, *names) ? i2d_X509(x509.get(), &der) : -1;
    const detail::DerPointer owned{der};
    ERR_clear_error();
    if (size <= 0) {
        return fail(status::Bad_InvalidArgument);
    }
    auto certificate =
        Certificate::parse(std::as_bytes(std::span{der, static_cast<std::size_t>(size)}));
    return certificate;
}

} // namespace busbar::crypto
