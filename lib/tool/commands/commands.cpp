#include "commands.hpp"

namespace busbar::tool {

namespace {

constexpr const char* footer =
    "Nodes are written i=2258, \"ns=2;s=Name\", \"nsu=urn:x;s=Name\" or\n"
    "/Objects/2:Machine/2:Speed, a server opc.tcp://host:4840, host:4840, or @NAME\n"
    "of a profile. Profiles are tables in ~/.config/busbar/profiles.toml, [NAME] with\n"
    "url, user, password-file, policy, mode, pki and other options of connections;\n"
    "options on the command line override them.\n"
    "`busbar COMMAND --help` has the options of a command; those above may also\n"
    "follow it. Values that begin with - must come after --.\n"
    "\n"
    "Exit codes: 0 good, 1 refused by the server or the disk, 2 usage,\n"
    "3 not connected, 4 security or login, 5 some of the nodes failed,\n"
    "129 the terminal went away, 130 interrupted.\n"
    "Environment: BUSBAR_URL, BUSBAR_PROFILE, BUSBAR_PASSWORD, XDG_CONFIG_HOME,\n"
    "XDG_DATA_HOME, NO_COLOR, COLUMNS.";

void add_commands(CLI::App& app, Run& run)
{
    add_discover(app, run);
    add_endpoints(app, run);
    add_browse(app, run);
    add_find(app, run);
    add_read(app, run);
    add_write(app, run);
    add_subscribe(app, run);
    add_watch(app, run);
    add_call(app, run);
    add_events(app, run);
    add_export(app, run);
    add_cert(app, run);
    add_admin(app, run);
    add_project(app, run);
    add_program(app, run);
    add_check(app, run);
    add_bench(app, run);
#ifdef BUSBAR_TOOL_HARNESS
    add_proxy(app, run);
    add_simulate(app, run);
    add_show(app, run);
    add_diff(app, run);
    add_replay(app, run);
#endif
    add_completion(app, run);
    add_help(app, run);
}

} // namespace

void add_command_line(CLI::App& app, Options& options, Run& run)
{
    app.require_subcommand(1);
    app.fallthrough();
    app.footer(footer);
    add_options(app, options);
    add_commands(app, run);
}

} // namespace busbar::tool
