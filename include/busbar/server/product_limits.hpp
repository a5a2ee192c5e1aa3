#pragma once

#include <busbar/core/api.hpp>
#include <busbar/server/limits.hpp>

/// The client limits of two shipping products, as their manuals publish them; limits that the
/// manuals do not name are those of ServerLimits.
namespace busbar::server {

/// NJ501 (its OPC UA manual, 1-2-2): 5 sessions, 100 Subscriptions, 2,000 items. The same for
/// NX102.
[[nodiscard]] BUSBAR_API ServerLimits nj501_limits();
[[nodiscard]] BUSBAR_API ServerLimits nx102_limits();
/// RD81OPC96 (its manual, 2.1): 15 sessions of 10 to 180 s; 25,000 nodes in a Read, 3,000 in a
/// Write, 10,000 in a Browse or a TranslateBrowsePathsToNodeIds, one Method in a Call; messages of
/// 3 MB, Strings of 1 KB, ByteStrings of 10 KB, arrays of 25,000 elements, beyond which a request
/// is Bad_EncodingLimitsExceeded. Arrays may have one more, so that a Read of one node too many can
/// be told from a malformed request.
[[nodiscard]] BUSBAR_API ServerLimits rd81opc96_limits();

} // namespace busbar::server
