#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/crypto/own_certificate.hpp>

namespace busbar::crypto {

/// Limits the cost of reading a file. The iterations of all its key derivations are added up and
/// checked before each of them: a million takes about a second.
struct Pkcs12Limits {
    std::size_t max_bytes{65'536};
    std::uint64_t max_iterations{3'000'000};
};

/// Reads the private key of a PKCS#12 file (RFC 7292), its certificate and, as far as they are
/// there, those that signed it, in order. Refused if a limit is exceeded, the passphrase is wrong,
/// or there is not exactly one RSA key with its certificate. Nested bags are ignored.
[[nodiscard]] BUSBAR_API Checked<OwnCertificate> read_pkcs12(std::span<const std::byte> contents,
                                                             std::string_view passphrase,
                                                             const Pkcs12Limits& limits = {});

} // namespace busbar::crypto
