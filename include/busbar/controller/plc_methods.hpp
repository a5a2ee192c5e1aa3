#pragma once

#include <cstdint>

#include <busbar/controller/plc.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/method_table.hpp>

namespace busbar::controller {

/// Adds the Methods of the simulated machine to the folder created by publish_variables:
///
/// - ResetCounters: the targets of Increment programs restart at 0 with the next scan. Returns the
///   number of these variables (`count`, UInt32).
///
/// `source` is the index that the server gave to `table`, which must not outlive `plc`. Errors are
/// those of AddressSpace.
BUSBAR_API Result<void> publish_methods(model::AddressSpace& address_space, model::NodeIndex folder,
                                        Plc& plc, server::MethodTable& table, std::uint32_t source);

} // namespace busbar::controller
