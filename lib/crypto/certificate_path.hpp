#pragma once

#include <vector>

#include <busbar/crypto/certificate.hpp>

namespace busbar::crypto::detail {

/// The chain from a leaf to a root, and the first thing wrong with it in the order of Part
/// 4, 6.1.3, table 100; times, trust and the leaf itself are checked by others.
struct CertificatePath {
    CertificateChain certificates; // leaf first; as far as it was found
    StatusCode build;              // Bad_CertificateChainIncomplete, Bad_CertificateInvalid
    StatusCode usage;              // Bad_CertificateIssuerUseNotAllowed
};

/// Builds the path of sent.front() from the others in `sent` and from `known`, which stand in any
/// order, roots and others. At most max_chain_length certificates; loops end. Among issuers that
/// would do, those that are known and valid at `now` come first.
[[nodiscard]] CertificatePath find_path(const CertificateChain& sent,
                                        const std::vector<Certificate>& known, DateTime now);

} // namespace busbar::crypto::detail
