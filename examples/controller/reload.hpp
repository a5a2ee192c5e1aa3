#pragma once

#include <string>

#include "admission.hpp"
#include "config.hpp"

namespace busbar::example {

/// Reads the users of the configuration file `path` and the trust lists again, for a controller
/// that runs with `admission`. What was read, as a line for the log. Throws ConfigError; then
/// everything is as it was.
[[nodiscard]] std::string reload(const std::string& path, Admission& admission, DateTime now);

} // namespace busbar::example
