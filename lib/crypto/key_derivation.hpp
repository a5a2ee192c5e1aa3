#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "openssl.hpp"

/// The cost of decrypting with a passphrase. The file itself sets it, and a hostile one sets days.
namespace busbar::crypto::detail {

/// Returns the number of hash iterations of a password-based encryption scheme (RFC 8018: PBES1,
/// PBES2 with PBKDF2; RFC 7292, appendix C). Nothing for every other scheme and for unreadable
/// parameters.
[[nodiscard]] std::optional<std::uint64_t> iterations_of(const X509_ALGOR& algorithm);

/// Returns false if the contents are, as PEM or DER, an encrypted PKCS#8 key whose key derivation
/// cannot be read or takes more iterations than `limit`. Everything else is affordable.
[[nodiscard]] bool is_affordable_key(std::span<const std::byte> contents, std::uint64_t limit);

} // namespace busbar::crypto::detail
