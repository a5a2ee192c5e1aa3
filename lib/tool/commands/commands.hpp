#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "command_line/completion.hpp"
#include "tool/connection/context.hpp"

namespace busbar::tool {

/// All that the program understands: its options and its commands. Of a command that was parsed,
/// `run` is what carries it out; both must live as long as `app`.
void add_command_line(CLI::App& app, Options& options, Run& run);

} // namespace busbar::tool

/// One function for each command, in a file of its name: adds the command to the program and has
/// `run` carry it out if it is the one that the user gave.
namespace busbar::tool {

void add_discover(CLI::App& app, Run& run);
void add_endpoints(CLI::App& app, Run& run);
void add_browse(CLI::App& app, Run& run);
void add_find(CLI::App& app, Run& run);
void add_read(CLI::App& app, Run& run);
void add_write(CLI::App& app, Run& run);
void add_subscribe(CLI::App& app, Run& run);
void add_watch(CLI::App& app, Run& run);
void add_call(CLI::App& app, Run& run);
void add_events(CLI::App& app, Run& run);
void add_export(CLI::App& app, Run& run);
void add_cert(CLI::App& app, Run& run);
void add_admin(CLI::App& app, Run& run);
void add_project(CLI::App& app, Run& run);
void add_program(CLI::App& app, Run& run);
void add_check(CLI::App& app, Run& run);
void add_bench(CLI::App& app, Run& run);
/// These need the harness, which a build may lack.
void add_proxy(CLI::App& app, Run& run);
void add_simulate(CLI::App& app, Run& run);
void add_show(CLI::App& app, Run& run);
void add_diff(CLI::App& app, Run& run);
void add_replay(CLI::App& app, Run& run);
void add_completion(CLI::App& app, Run& run);
void add_help(CLI::App& app, Run& run);

/// Returns what may stand at a place of the command line: names of profiles and, by asking the
/// server that the line names, nodes, methods and values. Empty where the server does not answer.
[[nodiscard]] std::vector<std::string> complete(const command_line::CompletionPlace& place);

/// Shows a server's claims (Part 5, 6.3.2): the profiles that it claims and, for the others, the
/// conformance units that it does not name. Throws Failure.
[[nodiscard]] Exit show_claims(Context& context);

} // namespace busbar::tool
