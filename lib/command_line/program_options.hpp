#pragma once

#include <string>

namespace CLI {
class App;
} // namespace CLI

namespace busbar::command_line {

/// Adds what every program answers: --version with "PROGRAM 0.1.0" and, for packaging, --print-man
/// with its manual page and --print-completion with a script for bash. The two are not in --help.
/// Each is thrown by App::parse as a CLI::Success whose text App::exit prints. Call it before the
/// command line is parsed; what is added to `app` later is on the page, too.
void add_program_options(CLI::App& app, const std::string& program);

} // namespace busbar::command_line
