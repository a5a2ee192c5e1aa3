#pragma once

#include <string>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/revocation_list.hpp>

namespace busbar::crypto::detail {

/// The last common name of a list's issuer, which is the most specific one; empty if there is none.
[[nodiscard]] std::string issuer_common_name(const RevocationList& list);

/// "Name [THUMBPRINT]" (Part 12, F.1): what a store calls a file, without the ending. The name is
/// the common name, of a revocation list that of its issuer, with everything but harmless
/// characters replaced: what a stranger says of himself is never a path.
[[nodiscard]] std::string store_file_name(const Certificate& certificate);
[[nodiscard]] std::string store_file_name(const RevocationList& list);

} // namespace busbar::crypto::detail
