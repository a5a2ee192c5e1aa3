#pragma once

#include <busbar/core/api.hpp>

namespace busbar::tool {

/// The program busbar: does what its command line says and gives the exit code. Takes the process's
/// SIGPIPE.
[[nodiscard]] BUSBAR_API int run_program(int argc, char** argv);

} // namespace busbar::tool
