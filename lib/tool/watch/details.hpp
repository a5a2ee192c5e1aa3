#pragma once

#include <string>
#include <vector>

#include "model.hpp"
#include "tool/nodes/variable_facts.hpp"

namespace busbar::tool::watch {

/// All that is known of a row, for a screen of so many columns: the whole value, its type, status
/// and times. `node` is the node as the server knows it.
[[nodiscard]] std::vector<std::string> details_of(const Row& row, const std::string& node,
                                                  const ValueFacts& facts, const Types& types,
                                                  std::size_t columns);

} // namespace busbar::tool::watch
