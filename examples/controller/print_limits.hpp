#pragma once

#include <string>

#include "config.hpp"

namespace busbar::example {

/// What --print-limits prints: each limit in force with its value, the key of [limits] that sets
/// it, the memory that peers can make the controller hold by it, and the sum.
[[nodiscard]] std::string describe_limits(const ControllerConfig& config);
/// Prints that of a file, of the built-in configuration without one; 0, as a program's end.
int print_limits(const std::string& file);
/// Bytes as people read them: "900 B", "64.0 KiB", "1.5 GiB".
[[nodiscard]] std::string size_text(std::uint64_t bytes);

} // namespace busbar::example
