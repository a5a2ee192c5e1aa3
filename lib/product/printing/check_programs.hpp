#pragma once

#include <string>
#include <vector>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// Prints for each file of a program what would be published with the limits of the configuration,
/// what not, and what is left out, each with its reason. Without files it takes the program of the
/// configuration. Returns 0 if all of it is understood and everything that is to be published would
/// be, otherwise 1.
int check_programs(const ControllerConfig& config, std::vector<std::string> files, bool is_json);

} // namespace busbar::product
