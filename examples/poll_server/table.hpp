#pragma once

#include <busbar/model/address_space.hpp>
#include <busbar/server/modules.hpp>

namespace poll_server {

/// The parts that the server has beyond those of every server.
[[nodiscard]] busbar::server::ModuleTable modules();
/// The nodes that it begins with.
[[nodiscard]] busbar::model::AddressSpace address_space();

} // namespace poll_server
