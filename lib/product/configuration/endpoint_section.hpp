#pragma once

#include "config.hpp"

namespace busbar::product {

/// [[endpoint]], or [security], which says it in the products' ways; what neither says is the
/// default. After the users: endpoints offer what kinds of them there are.
void read_endpoints(const TomlTable& root, ControllerConfig& config);

} // namespace busbar::product
