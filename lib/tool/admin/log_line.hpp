#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <busbar/controller/execution_log_reader.hpp>

#include "tool/printing/json_writer.hpp"

namespace busbar::tool::admin {

/// Whether a file of this name is one of an execution log (W588, 7-1-5): also no path.
[[nodiscard]] bool is_log_name(std::string_view name);
/// Whether it is the one that is being written.
[[nodiscard]] bool is_current_log(std::string_view name);

/// The columns of W588, 7-2-2, for an output of so many columns.
[[nodiscard]] std::string log_title(std::size_t columns);
/// An entry below that title. Details that there is no room for stand below it.
[[nodiscard]] std::string log_line(const controller::ExecutionLogEntry& entry, std::size_t columns);
/// {"entry": 7, "time": "2017-10-17T14:52:50.878", ...}; the time is that of the controller's
/// place.
void append_entry(JsonLine& json, const controller::ExecutionLogEntry& entry);

} // namespace busbar::tool::admin
