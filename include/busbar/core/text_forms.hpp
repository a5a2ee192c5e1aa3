#pragma once

#include <optional>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/types.hpp>

namespace busbar {

/// Reads "2026-11-21T06:00:00.123Z" or "2026-11-21" (xs:dateTime and xs:date); "+01:00" may replace
/// the "Z", and without either the time is UTC. A time outside of the range of DateTime becomes one
/// of its ends (Part 6, 5.3.1.6). This and the next functions return nothing for a text of another
/// form.
[[nodiscard]] BUSBAR_API std::optional<DateTime> parse_date_time(std::string_view text);
/// Reads "svr=1;nsu=urn:x;i=5"; one or both of the first two parts may be missing (Part 6,
/// 5.3.1.11).
[[nodiscard]] BUSBAR_API std::optional<ExpandedNodeId>
parse_expanded_node_id(std::string_view text);
/// Reads "Bad_Timeout", "0x800A0000" or "2148139008".
[[nodiscard]] BUSBAR_API std::optional<StatusCode> parse_status_code(std::string_view text);

} // namespace busbar
