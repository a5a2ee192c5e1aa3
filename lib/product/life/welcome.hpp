#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <busbar/core/date_time.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// The text for people when the controller is ready: how to reach it, the users that may log in,
/// what is left to do. `config` must be complete; `task_priority` is what the system granted to the
/// PLC's task; empty for a runtime's own.
[[nodiscard]] std::string welcome_text(const ControllerConfig& config, std::size_t variables,
                                       DateTime now, std::optional<int> task_priority);

/// The steps from a controller without any user to the first values.
[[nodiscard]] std::string setup_text(const std::string& url);

} // namespace busbar::product
