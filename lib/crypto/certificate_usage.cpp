#include <openssl/err.h>

#include "certificate_checks.hpp"
#include "openssl.hpp"

/// The step "Certificate Usage" of Part 4, 6.1.3, Table 100.
namespace busbar::crypto::detail {

namespace {

using NameConstraints = std::unique_ptr<NAME_CONSTRAINTS, FreeWith<NAME_CONSTRAINTS_free>>;

bool is_critical(const Certificate& certificate, int extension)
{
    const int at = X509_get_ext_by_NID(certificate.native(), extension, -1);
    return at >= 0 && X509_EXTENSION_get_critical(X509_get_ext(certificate.native(), at)) != 0;
}

/// The usage of the key: an application signs and decrypts with it, a user signs. Part 6, 6.2.2
/// lists nonRepudiation and keyEncipherment too, which the protocol never needs and not all
/// certificates have.
std::uint32_t needed_key_usage(CertificatePurpose purpose)
{
    return purpose == CertificatePurpose::User ? KU_DIGITAL_SIGNATURE
                                               : KU_DIGITAL_SIGNATURE | KU_DATA_ENCIPHERMENT;
}

/// Part 6, 6.2.2: serverAuth for servers, clientAuth for clients. One of these is enough; all bits
/// if nothing is required.
std::uint32_t possible_extended_usage(CertificatePurpose purpose)
{
    switch (purpose) {
    case CertificatePurpose::Application:
        return XKU_SSL_SERVER | XKU_SSL_CLIENT | XKU_ANYEKU;
    case CertificatePurpose::ServerApplication:
        return XKU_SSL_SERVER | XKU_ANYEKU;
    case CertificatePurpose::ClientApplication:
        return XKU_SSL_CLIENT | XKU_ANYEKU;
    case CertificatePurpose::User:
        break;
    }
    return UINT32_MAX;
}

std::string_view extended_usage_text(CertificatePurpose purpose)
{
    switch (purpose) {
    case CertificatePurpose::ServerApplication:
        return "serverAuth";
    case CertificatePurpose::ClientApplication:
        return "clientAuth";
    default:
        return "serverAuth or clientAuth";
    }
}

/// Returns the number of CAs below this one, without those of its own name (RFC 5280, 4.2.1.9).
long path_length_below(const CertificateChain& path, std::size_t index)
{
    long count = 0;
    for (std::size_t i = 1; i < index; ++i) {
        const bool is_self_issued = (X509_get_extension_flags(path[i].native()) & EXFLAG_SI) != 0;
        count += is_self_issued ? 0 : 1;
    }
    return count;
}

/// RFC 5280, 4.2.1.10: returns whether a CA may sign for the names of all certificates below it.
bool allows_names_below(const CertificateChain& path, std::size_t index)
{
    int critical = -1;
    const NameConstraints constraints{static_cast<NAME_CONSTRAINTS*>(
        X509_get_ext_d2i(path[index].native(), NID_name_constraints, &critical, nullptr))};
    bool is_allowed = constraints != nullptr || critical == -1; // -1: there are none
    for (std::size_t i = 0; i < index && is_allowed && constraints; ++i) {
        is_allowed = NAME_CONSTRAINTS_check(path[i].native(), constraints.get()) == X509_V_OK;
    }
    ERR_clear_error();
    return is_allowed;
}

} // namespace

/// Part 6, 6.2.2 and 6.2.3. A certificate without the extension may be used for anything.
std::optional<Finding> check_usage(const Validation& validation, std::size_t)
{
    const Certificate& leaf = validation.path.front();
    const CertificatePurpose purpose = validation.context.purpose;
    // Both functions return all bits for a certificate without the extension.
    const std::uint32_t needed = needed_key_usage(purpose);
    if ((X509_get_key_usage(leaf.native()) & needed) != needed) {
        return Finding{purpose == CertificatePurpose::User
                           ? "its key usage lacks digitalSignature"
                           : "its key usage lacks digitalSignature or dataEncipherment",
                       "The peer needs a certificate with this key usage",
                       is_critical(leaf, NID_key_usage)};
    }
    if ((X509_get_extended_key_usage(leaf.native()) & possible_extended_usage(purpose)) == 0) {
        return Finding{"its extended key usage lacks " + std::string{extended_usage_text(purpose)},
                       "The peer needs a certificate with this extended key usage",
                       is_critical(leaf, NID_ext_key_usage)};
    }
    if (purpose == CertificatePurpose::User && X509_check_ca(leaf.native()) == 1) {
        return Finding{"it is a CA's, not a user's", "The user needs a certificate of their own",
                       is_critical(leaf, NID_basic_constraints)};
    }
    return std::nullopt;
}

/// Part 6, 6.2.4. OpenSSL would accept a root of version 1 and a CA without basicConstraints.
std::optional<Finding> check_issuer_usage(const Validation& validation, std::size_t index)
{
    const Certificate& issuer = validation.path[index];
    const long path_length = X509_get_pathlen(issuer.native());
    const char* found = nullptr;
    if (X509_check_ca(issuer.native()) != 1) {
        found = "it is not marked as a CA that may sign certificates (basicConstraints cA, key "
                "usage keyCertSign)";
    } else if (path_length >= 0 && path_length_below(validation.path, index) > path_length) {
        found = "it allows fewer CAs below it than there are (pathLenConstraint)";
    } else if (!allows_names_below(validation.path, index)) {
        found = "it may not sign for the names below it (nameConstraints)";
    }
    if (found == nullptr) {
        return std::nullopt;
    }
    return Finding{found, "The peer needs a certificate of another CA"};
}

} // namespace busbar::crypto::detail
