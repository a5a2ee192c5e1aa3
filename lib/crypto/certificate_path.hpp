#pragma once

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/trust_list.hpp>

#include "signature_checks.hpp"

namespace busbar::crypto::detail {

/// Returns the path from sent.front() to a root, inclusive, with good signatures only; or the
/// refusal of the steps "Build Certificate Chain" and "Signature" of Part 4, 6.1.3, Table 100. A
/// self-signed leaf is a path by itself.
///
/// Issuers are searched first among the trusted certificates, then among the issuers, then among
/// the sent ones; of each, those that are valid at `now` first. A path with a trusted certificate
/// is preferred to one without.
[[nodiscard]] Checked<CertificateChain> find_path(const CertificateChain& sent,
                                                  const TrustList& list, DateTime now,
                                                  SignatureChecks& signatures);

} // namespace busbar::crypto::detail
