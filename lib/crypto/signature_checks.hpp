#pragma once

#include <cstddef>
#include <vector>

#include <busbar/crypto/revocation_list.hpp>

namespace busbar::crypto::detail {

/// Verifies the signatures of one validation: at most max_signature_checks, none of them twice.
class SignatureChecks {
public:
    /// Returns false also when all checks are used up.
    [[nodiscard]] bool is_signed_by(const Certificate& certificate, const Certificate& issuer);
    [[nodiscard]] bool is_signed_by(const RevocationList& list, const Certificate& issuer);
    [[nodiscard]] std::size_t count() const { return done_.size(); }
    [[nodiscard]] bool is_used_up() const;

private:
    struct Check {
        const void* what; // X509 or X509_CRL
        const x509_st* issuer;
        bool is_good;
    };

    template <typename Verify>
    bool once(const void* what, const Certificate& issuer, Verify verify);

    std::vector<Check> done_;
};

} // namespace busbar::crypto::detail
