#pragma once

#include <cstddef>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/self_signed.hpp>

namespace busbar::crypto {

/// Creates a certificate request for a CA (Part 12, 7.9.3 and 7.10.10): PKCS#10 in DER, signed with
/// SHA-256 by `key`, the key to be certified. It has the subject's names and, as requested
/// extensions, the alternative names and usages of Part 6, 6.2.2; the CA decides the validity.
/// Bad_InvalidArgument if a name or address cannot be used in a certificate.
[[nodiscard]] BUSBAR_API Result<std::vector<std::byte>>
create_signing_request(const PrivateKey& key, const CertificateSubject& subject);

} // namespace busbar::crypto
