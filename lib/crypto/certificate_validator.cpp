#include <busbar/crypto/certificate_validator.hpp>

namespace busbar::crypto {

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
