#pragma once

#include <vector>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>

namespace busbar::crypto::detail {

/// The first of `certificates` that `key` belongs to and, behind it, those that signed it, each its
/// predecessor; max_chain_length at most. Empty if `key` belongs to none. What signed nothing is
/// left out.
[[nodiscard]] CertificateChain chain_of(const PrivateKey& key,
                                        const std::vector<Certificate>& certificates);

} // namespace busbar::crypto::detail
