#pragma once

#include <string>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/revocation_list.hpp>

namespace busbar::crypto::detail {

/// "Name [THUMBPRINT]" (Part 12, F.1): what a store calls a file, without the ending. The name is
/// the common name, of a revocation list that of its issuer, with everything but harmless
/// characters replaced: what a stranger says of himself is never a path.
[[nodiscard]] std::string store_file_name(const Certificate& certificate);
[[nodiscard]] std::string store_file_name(const RevocationList& list);

} // namespace busbar::crypto::detail
