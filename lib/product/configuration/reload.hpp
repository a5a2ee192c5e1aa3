#pragma once

#include <string>

#include "product/access/admission.hpp"
#include "settings.hpp"

namespace busbar::product {

/// Reads everything again that may change while the controller runs: the users and the settings in
/// the file at `path`, which is empty for the built-in one, and the trust lists. Returns a text for
/// the log. A ConfigError changes nothing.
[[nodiscard]] std::string reload(const std::string& path, Settings& settings, Admission& admission,
                                 DateTime now);

} // namespace busbar::product
