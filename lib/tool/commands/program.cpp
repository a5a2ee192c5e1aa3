#include <busbar/tool/program.hpp>

#include <algorithm>
#include <csignal>
#include <exception>
#include <sstream>

#include "command_line/program_options.hpp"
#include "commands.hpp"
#include "tool/connection/context.hpp"
#include "tool/connection/failure.hpp"

namespace busbar::tool {

namespace {

void report(Context& context, const Failure& failure)
{
    if (context.options.is_json) {
        context.out.write(json_of(failure));
    } else {
        context.err.write(text_of(failure, context.err));
    }
}

/// Prints the text that --help or --version requested like any other output, and an error in the
/// command line like any other failure.
int end_early(Context& context, const CLI::App& app, const CLI::ParseError& error)
{
    std::ostringstream text;
    std::ostringstream ignored;
    // Help on a command that there is not would be that of the program.
    const bool has_unknown_command = app.get_subcommands().empty() && !app.remaining().empty() &&
                                     std::string_view{error.get_name()} == "CallForHelp";
    if (app.exit(error, text, ignored) != 0 || has_unknown_command) {
        throw usage_failure(app, error);
    }
    context.out.write(text.str());
    return static_cast<int>(Exit::Good);
}

int run_command(Context& context, int argc, char** argv)
{
    Run run;
    CLI::App app{"Looks into OPC UA servers and works with them.", "busbar"};
    command_line::add_program_options(app, "busbar", complete);
    add_command_line(app, context.options, run);
    if (argc == 1) {
        context.err.write(app.help());
        return static_cast<int>(Exit::Usage);
    }
    try {
        app.parse(protected_arguments(argc, argv));
    } catch (const CLI::ParseError& error) {
        // It may follow the mistake.
        context.options.is_json =
            std::find(argv, argv + argc, std::string_view{"--json"}) != argv + argc;
        return end_early(context, app, error);
    }
    context.options.given = given_options(app);
    complete_options(context.options);
    return static_cast<int>(run(context));
}

int run_until_failure(Context& context, int argc, char** argv)
{
    try {
        return run_command(context, argc, argv);
    } catch (const Interrupted&) {
        return static_cast<int>(Exit::Interrupted);
    } catch (const Failure& failure) {
        report(context, failure);
        return static_cast<int>(failure.exit);
    } catch (const std::exception& error) {
        report(context, Failure{Exit::Failed, error.what()});
        return static_cast<int>(Exit::Failed);
    }
}

} // namespace

int run_program(int argc, char** argv)
{
    std::signal(SIGPIPE, SIG_IGN); // writing fails then, which ends the command
    Context context;
    try {
        return run_until_failure(context, argc, argv);
    } catch (const OutputClosed&) {
        return static_cast<int>(Exit::Good);
    } catch (const Failure& failure) { // not even the first one could be reported
        context.err.write(text_of(failure, context.err));
        return static_cast<int>(failure.exit);
    }
}

} // namespace busbar::tool
