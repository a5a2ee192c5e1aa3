#pragma once

#include "config.hpp"

namespace busbar::example {

/// [certificates]
void read_certificates(const TomlTable& table, ControllerConfig& config);
/// [users]
void read_users(const TomlTable& table, ControllerConfig& config);
/// [[endpoint]], after the users: endpoints offer what kinds of them there are.
void read_endpoints(const TomlTable& root, ControllerConfig& config);

} // namespace busbar::example
