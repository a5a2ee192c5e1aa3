#include <busbar/crypto/certificate_validator.hpp>

#include "openssl.hpp"

namespace busbar::crypto {

namespace {

/// Part 6, 6.2.2: an application signs and decrypts with its key.
bool usage_allows(X509* certificate)
{
    const std::uint32_t usage = X509_get_key_usage(certificate); // all bits if there is none
    constexpr std::uint32_t needed = KU_DIGITAL_SIGNATURE | KU_DATA_ENCIPHERMENT;
    return (usage & needed) == needed;
}

} // namespace

Result<void> check_certificate(const Certificate& leaf, const ValidationContext& context)
{
    // In the order of Part 4, 6.1.3, table 100, for what needs no trust list.
    const std::uint32_t bits = leaf.key_bits();
    if (bits == 0) {
        return fail(status::Bad_CertificateInvalid);
    }
    if (context.policy != nullptr && !context.policy->is_none() &&
        (bits < context.policy->min_key_bits || bits > context.policy->max_key_bits)) {
        return fail(status::Bad_CertificatePolicyCheckFailed);
    }
    if (context.now < leaf.valid_from() || context.now > leaf.valid_to()) {
        return fail(status::Bad_CertificateTimeInvalid);
    }
    if (!context.application_uri.empty() && leaf.application_uri() != context.application_uri) {
        return fail(status::Bad_CertificateUriInvalid);
    }
    if (!usage_allows(leaf.native())) {
        return fail(status::Bad_CertificateUseNotAllowed);
    }
    return {};
}

Result<void> InsecureAcceptAnyCertificate::validate(const CertificateChain& chain,
                                                    const ValidationContext& context)
{
    const std::uint32_t bits = chain.front().key_bits();
    if (bits == 0 || (context.policy != nullptr && bits > context.policy->max_key_bits &&
                      !context.policy->is_none())) {
        return fail(status::Bad_CertificateInvalid);
    }
    return {};
}

} // namespace busbar::crypto
