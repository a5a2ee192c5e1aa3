#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "openssl.hpp"

/// What decrypting with a passphrase would cost. Files say it themselves: a hostile one asks for
/// days.
namespace busbar::crypto::detail {

/// How often a password-based encryption scheme hashes (RFC 8018: PBES1, PBES2 with PBKDF2; RFC
/// 7292, appendix C). None for every other scheme and for parameters that cannot be read.
[[nodiscard]] std::optional<std::uint64_t> iterations_of(const X509_ALGOR& algorithm);

/// False if the contents are, as PEM or DER, an encrypted PKCS#8 key whose key derivation cannot be
/// read or takes more iterations than `limit`. Everything else is affordable.
[[nodiscard]] bool is_affordable_key(std::span<const std::byte> contents, std::uint64_t limit);

} // namespace busbar::crypto::detail
