#include "certificate_checks.hpp"

#include <algorithm>

#include <openssl/err.h>

#include <busbar/crypto/certificate_validator.hpp>

#include "openssl.hpp"

namespace busbar::crypto::detail {

template <typename Verify>
bool SignatureChecks::once(const void* what, const Certificate& issuer, Verify verify)
{
    const auto known = std::find_if(done_.begin(), done_.end(), [&](const Check& check) {
        return check.what == what && check.issuer == issuer.native();
    });
    if (known != done_.end()) {
        return known->is_good;
    }
    if (is_used_up()) {
        return false;
    }
    done_.push_back({what, issuer.native(), verify()});
    return done_.back().is_good;
}

bool SignatureChecks::is_signed_by(const Certificate& certificate, const Certificate& issuer)
{
    return once(certificate.native(), issuer, [&] {
        const bool is_good =
            X509_verify(certificate.native(), X509_get0_pubkey(issuer.native())) == 1;
        ERR_clear_error();
        return is_good;
    });
}

bool SignatureChecks::is_signed_by(const RevocationList& list, const Certificate& issuer)
{
    return once(list.native(), issuer, [&] { return list.is_signed_by(issuer); });
}

bool SignatureChecks::is_used_up() const
{
    return done_.size() >= max_signature_checks;
}

} // namespace busbar::crypto::detail
