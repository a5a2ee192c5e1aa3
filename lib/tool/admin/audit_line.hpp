#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tool/stream/event_stream.hpp"

namespace busbar::tool::admin {

/// What audit events are asked for behind the standard fields (Part 5, 6.4.3 and 6.4.7).
[[nodiscard]] std::vector<std::string> audit_fields();

/// The name of an event type without what all of them say: "OpenSecureChannel" for
/// AuditOpenSecureChannelEventType.
[[nodiscard]] std::string_view short_name(std::string_view event_type);

inline constexpr const char* audit_title =
    "TIME          EVENT               USER          DONE  MESSAGE";
/// An event with these fields on a line of at most so many columns. `event` is its short name.
/// `fields` are as many as were asked for.
[[nodiscard]] std::string audit_line(const Output& out, std::string_view event,
                                     const EventFields& fields, std::size_t columns);

} // namespace busbar::tool::admin
