#include <busbar/crypto/revocation_list.hpp>

#include <algorithm>

#include <openssl/err.h>
#include <openssl/pem.h>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

/// PEM is a third larger than DER, and may have text around it.
constexpr std::size_t max_list_file_size = 2 * RevocationList::max_size;

/// Partial and indirect lists have issuingDistributionPoint, delta lists deltaCRLIndicator. Both
/// must be critical, but an issuer that forgets that still means it (RFC 5280, 5.2).
bool limits_scope(X509_EXTENSION* extension)
{
    const int id = OBJ_obj2nid(X509_EXTENSION_get_object(extension));
    return id == NID_issuing_distribution_point || id == NID_delta_crl ||
           X509_EXTENSION_get_critical(extension) != 0;
}

bool limits_scope(const X509_REVOKED* entry)
{
    for (int i = 0; i < X509_REVOKED_get_ext_count(entry); ++i) {
        if (X509_EXTENSION_get_critical(X509_REVOKED_get_ext(entry, i)) != 0) {
            return true;
        }
    }
    return false;
}

bool says_it_all(X509_CRL* list)
{
    for (int i = 0; i < X509_CRL_get_ext_count(list); ++i) {
        if (limits_scope(X509_CRL_get_ext(list, i))) {
            return false;
        }
    }
    const STACK_OF(X509_REVOKED)* entries = X509_CRL_get_REVOKED(list);
    for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
        if (limits_scope(sk_X509_REVOKED_value(entries, i))) {
            return false;
        }
    }
    return true;
}

std::vector<std::byte> der_of(X509_CRL* list)
{
    std::vector<std::byte> der;
    unsigned char* bytes = nullptr;
    const int size = i2d_X509_CRL(list, &bytes);
    if (size > 0) {
        const auto view = std::as_bytes(std::span{bytes, static_cast<std::size_t>(size)});
        der.assign(view.begin(), view.end());
        OPENSSL_free(bytes);
    }
    return der;
}

} // namespace

RevocationList::RevocationList(std::shared_ptr<X509_crl_st> crl, std::vector<std::byte> der)
    : crl_{std::move(crl)}, der_{std::make_shared<const std::vector<std::byte>>(std::move(der))},
      is_complete_{says_it_all(crl_.get())}
{
}

Result<RevocationList> RevocationList::parse(std::span<const std::byte> der)
{
    const unsigned char* at = detail::bytes_of(der);
    detail::CrlPointer list{der.empty() || der.size() > max_size
                                ? nullptr
                                : d2i_X509_CRL(nullptr, &at, static_cast<long>(der.size()))};
    ERR_clear_error();
    if (!list || at != detail::bytes_of(der) + der.size()) {
        return fail(status::Bad_CertificateInvalid);
    }
    return RevocationList{std::shared_ptr<X509_crl_st>{std::move(list)}, {der.begin(), der.end()}};
}

Result<RevocationList> RevocationList::parse_file(std::span<const std::byte> contents)
{
    if (contents.size() > max_list_file_size) {
        return fail(status::Bad_CertificateInvalid);
    }
    const auto next_in = [](BIO* bio) {
        return detail::CrlPointer{
            PEM_read_bio_X509_CRL(bio, nullptr, detail::give_no_passphrase, nullptr)};
    };
    const detail::Bio bio = detail::memory_bio(contents);
    const detail::CrlPointer list = bio ? next_in(bio.get()) : nullptr;
    // A second list in the file would be ignored, and its revocations with it.
    const bool is_single = list && !next_in(bio.get());
    ERR_clear_error();
    if (!list) {
        return parse(contents);
    }
    return is_single ? parse(der_of(list.get())) : fail(status::Bad_CertificateInvalid);
}

std::string RevocationList::thumbprint_text() const
{
    return detail::hexadecimal(detail::sha1_of(*der_));
}

std::string RevocationList::issuer() const
{
    return detail::text_of(X509_CRL_get_issuer(crl_.get()));
}

DateTime RevocationList::this_update() const
{
    return detail::date_time_of(X509_CRL_get0_lastUpdate(crl_.get()));
}

DateTime RevocationList::next_update() const
{
    return detail::date_time_of(X509_CRL_get0_nextUpdate(crl_.get()));
}

std::size_t RevocationList::size() const
{
    const int count = sk_X509_REVOKED_num(X509_CRL_get_REVOKED(crl_.get()));
    return static_cast<std::size_t>(std::max(count, 0)); // -1: the list has no entries at all
}

bool RevocationList::names_issuer(const Certificate& issuer) const
{
    return X509_NAME_cmp(X509_CRL_get_issuer(crl_.get()), X509_get_subject_name(issuer.native())) ==
           0;
}

bool RevocationList::is_signed_by(const Certificate& issuer) const
{
    // X509_get_key_usage returns all bits for a certificate without the extension.
    if (!names_issuer(issuer) || (X509_get_key_usage(issuer.native()) & KU_CRL_SIGN) == 0) {
        return false;
    }
    const bool is_good = detail::names_one_algorithm(crl_.get(), *der_) &&
                         X509_CRL_verify(crl_.get(), X509_get0_pubkey(issuer.native())) == 1;
    ERR_clear_error();
    return is_good;
}

std::optional<DateTime> RevocationList::revoked_at(const Certificate& certificate) const
{
    X509_REVOKED* entry = nullptr;
    if (X509_CRL_get0_by_cert(crl_.get(), &entry, certificate.native()) != 1) {
        return std::nullopt;
    }
    return detail::date_time_of(X509_REVOKED_get0_revocationDate(entry));
}

} // namespace busbar::crypto
