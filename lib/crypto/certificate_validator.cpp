#include <busbar/crypto/certificate_validator.hpp>

#include <openssl/err.h>

#include "certificate_checks.hpp"
#include "openssl.hpp"

namespace busbar::crypto {

namespace detail {

namespace {

bool is_checked(const SecurityPolicy* policy)
{
    return policy != nullptr && !policy->is_none();
}

/// Part 7: the policies' CertificateSignatureAlgorithm is RSA with SHA-256; longer digests are no
/// weaker.
bool has_strong_digest(const Certificate& certificate)
{
    int digest = NID_undef;
    return X509_get_signature_info(certificate.native(), &digest, nullptr, nullptr, nullptr) == 1 &&
           (digest == NID_sha256 || digest == NID_sha384 || digest == NID_sha512);
}

} // namespace

StatusCode check_structure(const Certificate& leaf)
{
    return leaf.key_bits() == 0 ? status::Bad_CertificateInvalid : StatusCode{};
}

StatusCode check_policy(const Certificate& leaf, const SecurityPolicy* policy)
{
    if (is_checked(policy) &&
        (leaf.key_bits() < policy->min_key_bits || leaf.key_bits() > policy->max_key_bits ||
         !has_strong_digest(leaf))) {
        return status::Bad_CertificatePolicyCheckFailed;
    }
    return {};
}

StatusCode check_issuer_policy(const Certificate& issuer, const SecurityPolicy* policy)
{
    const std::uint32_t bits = issuer.key_bits(); // 0 for other kinds of keys
    // What signs a root says nothing about it: nobody relies on a root's own signature.
    const bool is_root = X509_self_signed(issuer.native(), 0) == 1;
    if (is_checked(policy) &&
        ((bits != 0 && bits < policy->min_key_bits) || (!is_root && !has_strong_digest(issuer)))) {
        return status::Bad_CertificatePolicyCheckFailed;
    }
    return {};
}

bool is_valid_at(const Certificate& certificate, DateTime time)
{
    const DateTime from = certificate.valid_from();
    return !from.is_null() && from <= time && time <= certificate.valid_to();
}

StatusCode check_host_name(const Certificate& leaf, std::string_view host_name)
{
    if (host_name.empty()) {
        return {};
    }
    const std::string address{host_name};
    const bool matches =
        X509_check_host(leaf.native(), host_name.data(), host_name.size(), 0, nullptr) == 1 ||
        X509_check_ip_asc(leaf.native(), address.c_str(), 0) == 1;
    ERR_clear_error();
    return matches ? StatusCode{} : status::Bad_CertificateHostNameInvalid;
}

StatusCode check_application_uri(const Certificate& leaf, std::string_view uri)
{
    return uri.empty() || leaf.application_uri() == uri ? StatusCode{}
                                                        : status::Bad_CertificateUriInvalid;
}

/// Part 6, 6.2.2: an application signs and decrypts with its key, as a server or a client.
StatusCode check_usage(const Certificate& leaf)
{
    // Both functions give all bits for a certificate that does not say.
    constexpr std::uint32_t needed = KU_DIGITAL_SIGNATURE | KU_DATA_ENCIPHERMENT;
    constexpr std::uint32_t either = XKU_SSL_SERVER | XKU_SSL_CLIENT | XKU_ANYEKU;
    const bool is_allowed = (X509_get_key_usage(leaf.native()) & needed) == needed &&
                            (X509_get_extended_key_usage(leaf.native()) & either) != 0;
    return is_allowed ? StatusCode{} : status::Bad_CertificateUseNotAllowed;
}

} // namespace detail

Result<void> check_certificate(const Certificate& leaf, const ValidationContext& context)
{
    for (const StatusCode code :
         {detail::check_structure(leaf), detail::check_policy(leaf, context.policy),
          detail::is_valid_at(leaf, context.now) ? StatusCode{}
                                                 : status::Bad_CertificateTimeInvalid,
          detail::check_host_name(leaf, context.host_name),
          detail::check_application_uri(leaf, context.application_uri),
          detail::check_usage(leaf)}) {
        if (!code.is_good()) {
            return fail(code);
        }
    }
    return {};
}

Checked<void> InsecureAcceptAnyCertificate::validate(const CertificateChain& chain,
                                                     const ValidationContext& context)
{
    const std::uint32_t bits = chain.empty() ? 0 : chain.front().key_bits();
    const SecurityPolicy* policy = context.policy;
    if (bits == 0 || (policy != nullptr && !policy->is_none() &&
                      (bits < policy->min_key_bits || bits > policy->max_key_bits))) {
        return refuse({status::Bad_CertificateInvalid, "Certificate Structure",
                       "a key of " + std::to_string(bits) + " bits",
                       "Part 7, 6.6: key lengths of the policy",
                       "The peer needs another certificate"});
    }
    return {};
}

} // namespace busbar::crypto
