#pragma once

#include <busbar/controller/machine_nodes.hpp>

namespace busbar::controller::detail {

/// Adds the configuration of PLCopen with a resource, its tasks and its programs, and gives the
/// configuration's GlobalVars; no_node if the AddressSpace has no nodes of PLCopen.
[[nodiscard]] Configured<model::NodeIndex>
add_machine_configuration(model::AddressSpace& space, std::uint16_t namespace_index,
                          const Program& program, const MachineNodesOptions& options);

} // namespace busbar::controller::detail
