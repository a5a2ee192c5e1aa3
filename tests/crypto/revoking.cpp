#include "revoking.hpp"

#include <cstdlib>

#include <openssl/pem.h>

#include "crypto/openssl.hpp"

namespace busbar::test {

namespace {

using crypto::detail::Bio;
using crypto::detail::CrlPointer;
using crypto::detail::Extension;
using Time = std::unique_ptr<ASN1_TIME, crypto::detail::FreeWith<ASN1_TIME_free>>;
using Integer = std::unique_ptr<ASN1_INTEGER, crypto::detail::FreeWith<ASN1_INTEGER_free>>;

Time time_of(DateTime time)
{
    Time made{ASN1_TIME_new()};
    crypto::detail::set_time(made.get(), time);
    return made;
}

Extension unknown_extension(const std::string& der)
{
    ASN1_OBJECT* object = OBJ_txt2obj("1.2.3.4", 1);
    ASN1_OCTET_STRING* data = ASN1_OCTET_STRING_new();
    ASN1_OCTET_STRING_set(data, reinterpret_cast<const unsigned char*>(der.data()),
                          static_cast<int>(der.size()));
    Extension extension{X509_EXTENSION_create_by_OBJ(nullptr, object, 1, data)};
    ASN1_OCTET_STRING_free(data);
    ASN1_OBJECT_free(object);
    return extension;
}

void add(X509_CRL* list, X509* issuer, int id, const std::string& value)
{
    if (value.empty()) {
        return;
    }
    X509V3_CTX context;
    X509V3_set_ctx(&context, issuer, nullptr, nullptr, list, 0);
    const Extension extension{X509V3_EXT_conf_nid(nullptr, &context, id, value.c_str())};
    if (!extension || X509_CRL_add_ext(list, extension.get(), -1) != 1) {
        std::abort();
    }
}

void add_entries(X509_CRL* list, const RevocationOptions& options)
{
    const Time date = time_of(options.revoked_at);
    for (const crypto::Certificate& certificate : options.revoked) {
        X509_REVOKED* entry = X509_REVOKED_new();
        X509_REVOKED_set_serialNumber(entry, X509_get_serialNumber(certificate.native()));
        X509_REVOKED_set_revocationDate(entry, date.get());
        if (!options.entry_extra.empty()) {
            X509_REVOKED_add_ext(entry, unknown_extension(options.entry_extra).get(), -1);
        }
        X509_CRL_add0_revoked(list, entry);
    }
}

void add_extensions(X509_CRL* list, X509* issuer, const RevocationOptions& options)
{
    const Integer number{ASN1_INTEGER_new()};
    ASN1_INTEGER_set(number.get(), 7);
    X509_CRL_add1_ext_i2d(list, NID_crl_number, number.get(), 0, 0);
    add(list, issuer, NID_authority_key_identifier,
        X509_get0_subject_key_id(issuer) != nullptr ? "keyid" : "");
    add(list, issuer, NID_issuing_distribution_point, options.distribution_point);
    if (options.is_delta) {
        X509_CRL_add1_ext_i2d(list, NID_delta_crl, number.get(), 1, 0);
    }
    if (!options.extra.empty()) {
        X509_CRL_add_ext(list, unknown_extension(options.extra).get(), -1);
    }
}

} // namespace

crypto::RevocationList revoke(const Issued& issuer, const RevocationOptions& options)
{
    X509* const by = issuer.certificate.native();
    const CrlPointer list{X509_CRL_new()};
    X509_CRL_set_version(list.get(), X509_CRL_VERSION_2);
    X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(by));
    X509_CRL_set1_lastUpdate(list.get(), time_of(options.this_update).get());
    if (!options.next_update.is_null()) {
        X509_CRL_set1_nextUpdate(list.get(), time_of(options.next_update).get());
    }
    add_entries(list.get(), options);
    add_extensions(list.get(), by, options);
    X509_CRL_sign(list.get(), issuer.key.native(), EVP_get_digestbyname(options.digest));
    const Bio bio{BIO_new(BIO_s_mem())};
    i2d_X509_CRL_bio(bio.get(), list.get());
    return *crypto::RevocationList::parse(contents_of(bio.get()));
}

std::vector<std::byte> pem_of(const crypto::RevocationList& list)
{
    const Bio bio{BIO_new(BIO_s_mem())};
    PEM_write_bio_X509_CRL(bio.get(), list.native());
    return contents_of(bio.get());
}

} // namespace busbar::test
