#pragma once

#include <vector>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>

namespace busbar::crypto::detail {

/// Returns the first of `certificates` that `key` belongs to, followed by those that signed it,
/// each its predecessor; at most max_chain_length. Empty if `key` belongs to none. Certificates
/// that signed none of these are left out.
[[nodiscard]] CertificateChain chain_of(const PrivateKey& key,
                                        const std::vector<Certificate>& certificates);

} // namespace busbar::crypto::detail
