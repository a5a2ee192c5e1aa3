#pragma once

#include <string>

#include "completion.hpp"

namespace busbar::command_line {

/// Adds what every program answers: --version with "PROGRAM 0.1.0" and, for packaging, --print-man
/// with its manual page and --print-completion with a script for bash, and --complete LINE for that
/// script, with `completer` for what only the program knows. Those are not in --help, whose lines
/// get narrow enough for a terminal, and which names the program without its folder.
///
/// Each is thrown by App::parse as a CLI::Success whose text App::exit prints. Call it before the
/// command line is parsed, and before commands are added; what is added to `app` later is on the
/// page, too.
void add_program_options(CLI::App& app, const std::string& program,
                         const Completer& completer = {});

} // namespace busbar::command_line
