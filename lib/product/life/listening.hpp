#pragma once

#include <span>
#include <vector>

#include "product/configuration/config.hpp"

namespace busbar::product {

/// Where a configuration has the server listen; the first is where its clients find it.
[[nodiscard]] std::vector<FurtherListener> listeners_of(const ControllerConfig& config);
/// Has a configuration say this, which is not empty.
void set_listeners(ControllerConfig& config, std::span<const FurtherListener> listeners);
/// Whether the address is this machine's and the port is free, or 0. Opens nothing and logs
/// nothing.
[[nodiscard]] bool can_listen(const FurtherListener& listener);

} // namespace busbar::product
