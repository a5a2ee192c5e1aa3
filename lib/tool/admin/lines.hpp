#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/execution_log_reader.hpp>

#include "tool/printing/json_writer.hpp"
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

/// Tells whether a name belongs to a file of an execution log (W588, 7-1-5); paths never do.
[[nodiscard]] bool is_log_name(std::string_view name);
/// Tells whether it is the file that is being written.
[[nodiscard]] bool is_current_log(std::string_view name);

/// Writes the titles of the columns of W588, 7-2-2, for an output of so many columns.
[[nodiscard]] std::string log_title(std::size_t columns);
/// Writes an entry below that title; details that do not fit are put below it.
[[nodiscard]] std::string log_line(const controller::ExecutionLogEntry& entry, std::size_t columns);
/// Writes {"entry": 7, "time": "2017-10-17T14:52:50.878", ...}, with the local time of the
/// controller.
void append_entry(JsonLine& json, const controller::ExecutionLogEntry& entry);

} // namespace busbar::tool::admin
