#pragma once

#include "config.hpp"

namespace busbar::example {

/// [certificates]
void read_certificates(const TomlTable& table, ControllerConfig& config);
/// [users]
void read_users(const TomlTable& table, ControllerConfig& config);

} // namespace busbar::example
