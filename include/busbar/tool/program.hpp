#pragma once

#include <busbar/core/api.hpp>

namespace busbar::tool {

/// The program busbar: executes its command line and returns the exit code. Handles the process's
/// SIGPIPE.
[[nodiscard]] BUSBAR_API int run_program(int argc, char** argv);

} // namespace busbar::tool
