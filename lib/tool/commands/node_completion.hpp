#pragma once

#include <string>
#include <vector>

#include "command_line/completion.hpp"

namespace busbar::tool {

/// Returns what may stand at a place of the command line: names of profiles and, by asking the
/// server that the line names, nodes, methods and values. Empty where the server does not answer.
[[nodiscard]] std::vector<std::string> complete(const command_line::CompletionPlace& place);

} // namespace busbar::tool
