#pragma once

#include <vector>

#include <busbar/core/result.hpp>

#include "hostile.hpp"
#include "load.hpp"
#include "own_controller.hpp"
#include "tool_user.hpp"

namespace busbar::bench {

/// Programs, backups and projects that an administrator sends, takes and restores by `busbar`, a
/// row for each command with what a client saw meanwhile and the longest piece of the controller's
/// work. Commands that end all sessions cost that client a Read. `load` is the client's; the
/// controller is one of the given mode.
[[nodiscard]] Result<std::vector<HostileRow>> administer(Load& load, OwnController& controller,
                                                         const ToolUser& tool, bool is_model);

} // namespace busbar::bench
