#pragma once

#include <busbar/core/data_value.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>

namespace busbar::server::detail {

struct Core;
struct ValueReader;

/// The present value of a Variable below the Server object (Part 5, 6.3 and 8.3.2), i=2253, with
/// its source timestamp; Bad_NodeIdUnknown for any other node, whose value the address space or a
/// data source has. Takes constant time, but for the arrays of ServerDiagnostics, of which some
/// are not for every reader.
[[nodiscard]] Result<DataValue> server_value(const Core& core, const NodeId& node,
                                             const ValueReader& reader);

} // namespace busbar::server::detail
