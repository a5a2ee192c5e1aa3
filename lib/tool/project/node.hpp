#pragma once

#include <string>

#include "commands.hpp"

namespace busbar::tool::project {

/// All that a model says of one node, and what of it can be mapped to what (seed 001, 9.4). `text`
/// is a NodeId or a path from the Root.
Exit show_node(Context& context, const controller::Project& project, const std::string& text);

} // namespace busbar::tool::project
