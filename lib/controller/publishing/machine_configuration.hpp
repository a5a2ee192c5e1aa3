#pragma once

#include <busbar/controller/machine_nodes.hpp>

namespace busbar::controller::detail {

/// Adds a PLCopen configuration with a resource, its tasks and its programs, and returns the
/// configuration's GlobalVars; no_node if the AddressSpace has no PLCopen nodes.
[[nodiscard]] Configured<model::NodeIndex>
add_machine_configuration(model::AddressSpace& space, std::uint16_t namespace_index,
                          const Program& program, const MachineNodesOptions& options);

} // namespace busbar::controller::detail
