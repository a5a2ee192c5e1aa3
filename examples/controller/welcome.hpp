#pragma once

#include <cstddef>
#include <string>

#include <busbar/core/date_time.hpp>

#include "config.hpp"

namespace busbar::example {

/// What people read when the controller is ready: how to reach it, who may log in, what is left to
/// do. `config` is complete.
[[nodiscard]] std::string welcome_text(const ControllerConfig& config, std::size_t variables,
                                       DateTime now);

} // namespace busbar::example
