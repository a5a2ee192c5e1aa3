#pragma once

#include <string>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// What --print-capacities prints: how much a controller of this configuration can do at most, as a
/// table in Markdown. lib/CONFORMANCE.md has the one of the built-in configuration, which is what
/// Part 7 calls the documentation of core capacities.
[[nodiscard]] std::string describe_capacities(const ControllerConfig& config);
/// Prints that of a file, of the built-in configuration without one; 0, as a program's end.
int print_capacities(const std::string& file);

} // namespace busbar::product
