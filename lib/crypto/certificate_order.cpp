#include "certificate_order.hpp"

#include <openssl/err.h>

#include <algorithm>

#include "openssl.hpp"

namespace busbar::crypto::detail {

namespace {

bool has_signed(const Certificate& issuer, const Certificate& certificate)
{
    return X509_NAME_cmp(X509_get_subject_name(issuer.native()),
                         X509_get_issuer_name(certificate.native())) == 0 &&
           X509_verify(certificate.native(), X509_get0_pubkey(issuer.native())) == 1;
}

} // namespace

CertificateChain chain_of(const PrivateKey& key, const std::vector<Certificate>& certificates)
{
    CertificateChain chain;
    auto next = std::find_if(certificates.begin(), certificates.end(),
                             [&](const Certificate& c) { return key.belongs_to(c); });
    while (next != certificates.end() && chain.size() < max_chain_length) {
        chain.push_back(*next);
        next = std::find_if(certificates.begin(), certificates.end(), [&](const Certificate& c) {
            return std::find(chain.begin(), chain.end(), c) == chain.end() &&
                   has_signed(c, chain.back());
        });
    }
    ERR_clear_error();
    return chain;
}

} // namespace busbar::crypto::detail
