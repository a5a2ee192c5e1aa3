#pragma once

#include <string>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The text of --print-limits: each limit in force with its value, the key of [limits] that sets
/// it, the memory that peers can make the controller hold by it, and the sum.
[[nodiscard]] std::string describe_limits(const ControllerConfig& config);
/// Prints it for a file, or for the built-in configuration; returns 0 as exit code.
int print_limits(const std::string& file);

} // namespace busbar::product
