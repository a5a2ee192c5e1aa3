#pragma once

#include "config.hpp"

namespace busbar::product {

/// Reads [plc] with its variables and programs, and checks them by building the PLC once.
void read_plc(const TomlTable& table, ControllerConfig& config);

} // namespace busbar::product
