#pragma once

#include <vector>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/revocation_list.hpp>

namespace busbar::crypto {

/// An administrator's decisions about certificates (Part 12, 7.8.2.8, TrustListDataType).
struct TrustList {
    /// A certificate is trusted if it, or a CA above it, is one of these.
    std::vector<Certificate> trusted;
    /// CA certificates that complete chains but do not make anything trusted.
    std::vector<Certificate> issuers;
    /// Revocation lists of the CAs above. A list counts for its issuer in either place.
    std::vector<RevocationList> trusted_crls;
    std::vector<RevocationList> issuer_crls;
};

} // namespace busbar::crypto
