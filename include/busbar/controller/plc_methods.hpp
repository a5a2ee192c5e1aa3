#pragma once

#include <cstdint>

#include <busbar/controller/plc.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/method_table.hpp>

namespace busbar::controller {

/// Adds the Methods of the simulated machine to the folder that publish_variables made:
///
/// - ResetCounters: what Increment programs count begins again at 0 with the next scan. Returns how
///   many variables (`count`, UInt32) these are.
///
/// `source` is the index that the server gave to `table`, which must not outlive `plc`. Errors are
/// those of AddressSpace.
BUSBAR_API Result<void> publish_methods(model::AddressSpace& address_space, model::NodeIndex folder,
                                        Plc& plc, server::MethodTable& table, std::uint32_t source);

} // namespace busbar::controller
