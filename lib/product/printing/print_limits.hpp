#pragma once

#include <string>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// What --print-limits prints: each limit in force with its value, the key of [limits] that sets
/// it, the memory that peers can make the controller hold by it, and the sum.
[[nodiscard]] std::string describe_limits(const ControllerConfig& config);
/// Prints that of a file, of the built-in configuration without one; 0, as a program's end.
int print_limits(const std::string& file);

} // namespace busbar::product
