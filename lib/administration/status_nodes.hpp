#pragma once

#include <span>

#include <busbar/administration/status_fact.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"
#include "rights.hpp"

namespace busbar::administration::detail {

/// Adds the facts as Properties of an Object "Status" of the server's own namespace, below the
/// Objects folder. They can be read in every state of the server, by the roles that
/// Thing::ServiceStatus allows.
[[nodiscard]] Configured<void> add_status_nodes(server::Server& server, NodeTable& table,
                                                std::span<const StatusFact> facts,
                                                Authorities authorities);

} // namespace busbar::administration::detail
