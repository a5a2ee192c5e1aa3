#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <busbar/core/date_time.hpp>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// What people read when the controller is ready: how to reach it, who may log in, what is left to
/// do. `config` is complete, `task_priority` what the system granted to the PLC's task; nothing if
/// that is a runtime's own.
[[nodiscard]] std::string welcome_text(const ControllerConfig& config, std::size_t variables,
                                       DateTime now, std::optional<int> task_priority);

/// The steps from a controller that nobody can log in to yet to the first values.
[[nodiscard]] std::string setup_text(const std::string& url);

} // namespace busbar::product
