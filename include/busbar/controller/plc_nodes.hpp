#pragma once

#include <string>

#include <busbar/controller/plc.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::controller {

/// Names of the nodes of a simple PLC, and where their values come from.
struct PlcNodesOptions {
    std::string namespace_uri{"urn:busbar:plc"};
    /// The folder below Objects for the variables; its NodeId is this text, too.
    std::string folder{"PLC"};
    /// The index that the server gave to the PLC's ImageSource.
    std::uint32_t source{0};
    /// The task's cycle, which is the shortest sampling interval for clients.
    Duration cycle{std::chrono::milliseconds{20}};
};

/// Adds a folder with a node for each of the PLC's variables: its NodeId and BrowseName are the
/// variable's name, its handle the one in the PLC's image. Returns the folder. Errors are those of
/// AddressSpace; nodes that were added before an error stay.
BUSBAR_API Result<model::NodeIndex> publish_variables(model::AddressSpace& address_space,
                                                      const Plc& plc,
                                                      const PlcNodesOptions& options);

} // namespace busbar::controller
