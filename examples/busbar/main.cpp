#include <csignal>
#include <cstdio>
#include <exception>

#include "commands.hpp"

using namespace busbar::cli;

namespace {

constexpr const char* footer =
    "Nodes are written i=2258, \"ns=2;s=Name\", \"nsu=urn:x;s=Name\" or\n"
    "/Objects/2:Machine/2:Speed. `busbar COMMAND --help` has the options of a\n"
    "command; those above may stand behind it too.\n"
    "\n"
    "Exit codes: 0 good, 1 refused by the server or the disk, 2 usage,\n"
    "3 not connected, 4 security or login, 5 some of the nodes failed,\n"
    "130 interrupted.\n"
    "Environment: BUSBAR_URL, BUSBAR_PASSWORD, XDG_DATA_HOME, NO_COLOR, COLUMNS.";

void add_commands(CLI::App& app, Run& run)
{
    add_discover(app, run);
    add_endpoints(app, run);
    add_browse(app, run);
    add_read(app, run);
    add_write(app, run);
    add_subscribe(app, run);
    add_watch(app, run);
    add_call(app, run);
    add_events(app, run);
    add_export(app, run);
    add_cert(app, run);
    add_bench(app, run);
    add_completion(app, run);
}

void report(Context& context, const Failure& failure)
{
    if (context.options.is_json) {
        context.out.write(json_of(failure));
    } else {
        context.err.write(text_of(failure, context.err));
    }
}

int run_command(Context& context, const Run& run)
{
    try {
        return static_cast<int>(run(context));
    } catch (const OutputClosed&) {
        return 0;
    } catch (const Interrupted&) {
        return 130; // as shells have it for SIGINT
    } catch (const Failure& failure) {
        report(context, failure);
        return static_cast<int>(failure.exit);
    } catch (const std::exception& error) {
        report(context, Failure{Exit::Failed, error.what()});
        return static_cast<int>(Exit::Failed);
    }
}

} // namespace

int main(int argc, char** argv)
{
    std::signal(SIGPIPE, SIG_IGN); // writing fails then, which ends the command
    Context context;
    Run run;
    CLI::App app{"Looks into OPC UA servers and works with them.", "busbar"};
    app.set_version_flag("--version", "busbar " BUSBAR_VERSION);
    app.require_subcommand(1);
    app.fallthrough();
    app.footer(footer);
    add_options(app, context.options);
    add_commands(app, run);
    if (argc == 1) {
        std::fputs(app.help().c_str(), stderr);
        return static_cast<int>(Exit::Usage);
    }
    try {
        app.parse(protected_arguments(argc, argv));
    } catch (const CLI::ParseError& error) {
        // 0 for --help and --version.
        return app.exit(error) == 0 ? 0 : static_cast<int>(Exit::Usage);
    }
    try {
        return run_command(context, run);
    } catch (const OutputClosed&) {
        return 0;
    }
}
