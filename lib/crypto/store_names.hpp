#pragma once

#include <string>

#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/revocation_list.hpp>

namespace busbar::crypto::detail {

/// Returns the last common name of a list's issuer, which is the most specific one; empty if there
/// is none.
[[nodiscard]] std::string issuer_common_name(const RevocationList& list);

/// Returns "Name [THUMBPRINT]" (Part 12, F.1), the store's file name without the extension. The
/// name is the common name, for a revocation list that of its issuer, with everything except
/// harmless characters replaced: a name chosen by a stranger is never a path.
[[nodiscard]] std::string store_file_name(const Certificate& certificate);
[[nodiscard]] std::string store_file_name(const RevocationList& list);

} // namespace busbar::crypto::detail
