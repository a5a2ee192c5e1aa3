#pragma once

#include <busbar/server/conformance.hpp>

namespace busbar::server::detail {

struct Core;

/// Collects the facts about the server, when all modules have been added. Visits every node.
[[nodiscard]] ConformanceFacts conformance_facts(const Core& core);

} // namespace busbar::server::detail
