#pragma once

#include <string>

#include "product/access/admission.hpp"
#include "settings.hpp"

namespace busbar::product {

/// Reads again what may change while the controller runs: the users and the settings in the file at
/// `path`, which is empty for the built-in one, and the trust lists. What it found, for the log; a
/// ConfigError changes nothing.
[[nodiscard]] std::string reload(const std::string& path, Settings& settings, Admission& admission,
                                 DateTime now);

} // namespace busbar::product
