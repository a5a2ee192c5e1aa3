#pragma once

#include <string>

#include <busbar/controller/plc.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::controller {

struct PlcNodesOptions {
    std::string namespace_uri{"urn:busbar:plc"};
    /// The folder below Objects that has the variables; its NodeId is this text, too.
    std::string folder{"PLC"};
    /// The index that the server gave to the PLC's ImageSource.
    std::uint32_t source{0};
    /// The task's cycle: a client cannot sample faster.
    Duration cycle{std::chrono::milliseconds{20}};
};

/// Adds a folder, and in it a node for each of the PLC's variables: its NodeId and BrowseName are
/// the variable's name, its handle the one in the PLC's image. Gives the folder. Errors are those
/// of AddressSpace; what was added before an error stays.
BUSBAR_API Result<model::NodeIndex> publish_variables(model::AddressSpace& address_space,
                                                      const Plc& plc,
                                                      const PlcNodesOptions& options);

} // namespace busbar::controller
