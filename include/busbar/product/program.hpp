#pragma once

#include <busbar/core/api.hpp>

namespace busbar::product {

class Runtime;

/// The program busbar-controller: reads its command line and serves until it is stopped. Returns
/// the exit code: 0, 1 if it cannot serve, 2 for a wrong command line; both errors explain on
/// standard error what to do. Called once in a process, whose signals SIGHUP, SIGINT, SIGTERM and
/// SIGPIPE it handles.
[[nodiscard]] BUSBAR_API int run_program(int argc, char** argv);
/// Runs the program with another PLC than the simulated one.
[[nodiscard]] BUSBAR_API int run_program(int argc, char** argv, Runtime& runtime);

} // namespace busbar::product
