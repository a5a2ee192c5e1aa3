#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tool/stream/event_stream.hpp"

namespace busbar::tool::admin {

/// The fields of audit events to request after the standard ones (Part 5, 6.4.3 and 6.4.7).
[[nodiscard]] std::vector<std::string> audit_fields();

/// Shortens the name of an event type to the part that differs: "OpenSecureChannel" for
/// AuditOpenSecureChannelEventType.
[[nodiscard]] std::string_view short_name(std::string_view event_type);

inline constexpr const char* audit_title =
    "TIME          EVENT               USER          DONE  MESSAGE";
/// Writes an event on a line of at most so many columns. `event` is its short name. `fields` must
/// be as many as requested.
[[nodiscard]] std::string audit_line(const Output& out, std::string_view event,
                                     const EventFields& fields, std::size_t columns);

} // namespace busbar::tool::admin
