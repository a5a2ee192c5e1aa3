#pragma once

#include <busbar/core/node_id.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

/// True for a Method of the Server object that the server carries out itself (Part 5, 9.1 and 9.2).
[[nodiscard]] inline bool is_built_in_method(const NodeId& method)
{
    return method.is(id::Server_GetMonitoredItems) || method.is(id::Server_ResendData);
}

} // namespace busbar::server::detail
