#pragma once

#include <string>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The text of --print-capacities: the maximum capacities of a controller with this configuration,
/// as a Markdown table. lib/CONFORMANCE.md has the table of the built-in configuration; Part 7
/// calls it the documentation of core capacities.
[[nodiscard]] std::string describe_capacities(const ControllerConfig& config);
/// Prints it for a file, or for the built-in configuration; returns 0 as exit code.
int print_capacities(const std::string& file);

} // namespace busbar::product
