#pragma once

#include <busbar/server/conformance.hpp>

namespace busbar::server::detail {

struct Core;

/// What the server is made of, when all modules have been added. Looks at every node.
[[nodiscard]] ConformanceFacts conformance_facts(const Core& core);

} // namespace busbar::server::detail
