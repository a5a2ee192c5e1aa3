#pragma once

#include <busbar/model/address_space.hpp>
#include <busbar/server/modules.hpp>

namespace poll_server {

/// Which parts the server has beyond what every one has.
[[nodiscard]] busbar::server::ModuleTable modules();
/// The nodes it begins with.
[[nodiscard]] busbar::model::AddressSpace address_space();

} // namespace poll_server
