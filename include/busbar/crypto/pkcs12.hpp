#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/crypto/own_certificate.hpp>

namespace busbar::crypto {

/// What reading a file may cost. The iterations of all its key derivations are added up and checked
/// before each of them: a million takes about a second.
struct Pkcs12Limits {
    std::size_t max_bytes{65'536};
    std::uint64_t max_iterations{3'000'000};
};

/// The private key of a PKCS#12 file (RFC 7292), its certificate and those that signed it, as far
/// as they are there, in order. Refused if a limit is passed, the passphrase is wrong, or there is
/// not exactly one RSA key with its certificate. Bags within bags are not looked into.
[[nodiscard]] BUSBAR_API Checked<OwnCertificate> read_pkcs12(std::span<const std::byte> contents,
                                                             std::string_view passphrase,
                                                             const Pkcs12Limits& limits = {});

} // namespace busbar::crypto
