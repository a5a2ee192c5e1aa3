#include <busbar/crypto/certificate_validator.hpp>

#include <openssl/x509v3.h>

namespace busbar::crypto {

bool is_authority(const Certificate& certificate)
{
    return X509_check_ca(certificate.native()) == 1;
}

std::optional<Refusal> check_trust_list(const TrustList& list, DateTime now,
                                        CertificatePurpose purpose)
{
    constexpr ValidationSettings lenient{.suppress_security_policy_check = true,
                                         .suppress_validity_period = true,
                                         .suppress_issuer_validity_period = true,
                                         .suppress_host_name = true,
                                         .suppress_certificate_usage = true,
                                         .suppress_find_revocation_list = true,
                                         .suppress_find_issuer_revocation_list = true};
    ValidationContext context;
    context.now = now;
    context.purpose = purpose;
    for (const Certificate& certificate : list.trusted) {
        if (is_authority(certificate)) {
            continue;
        }
        if (auto refused = check_chain({certificate}, list, context, lenient)) {
            return refused;
        }
    }
    return std::nullopt;
}

} // namespace busbar::crypto
