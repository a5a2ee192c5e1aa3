#pragma once

#include <busbar/core/api.hpp>

namespace busbar::product {

class Runtime;

/// The program busbar-controller: reads its command line and serves until it is stopped. Gives the
/// exit code: 0, 1 if it cannot serve, 2 for a command line that is wrong; both say on standard
/// error what to do. Once in a process, whose signals SIGHUP, SIGINT, SIGTERM and SIGPIPE it takes.
[[nodiscard]] BUSBAR_API int run_program(int argc, char** argv);
/// The same around another PLC than the simulated one.
[[nodiscard]] BUSBAR_API int run_program(int argc, char** argv, Runtime& runtime);

} // namespace busbar::product
