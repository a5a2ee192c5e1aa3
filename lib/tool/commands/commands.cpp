#include "tool/project/commands.hpp"

#include <memory>

#include "command_line/completion.hpp"
#include "commands.hpp"
#include "tool/admin/commands.hpp"

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

void add_admin(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("admin", "Administers a server that runs.");
    command->require_subcommand(1);
    admin::add_status(*command, run);
    admin::add_own(*command, run);
    admin::add_trust(*command, run);
    admin::add_users(*command, run);
    admin::add_roles(*command, run);
    admin::add_settings(*command, run);
    admin::add_files(*command, run);
    admin::add_audit(*command, run);
    admin::add_log(*command, run);
    admin::add_events(*command, run);
    admin::add_backup(*command, run);
    admin::add_program(*command, run);
    admin::add_mode(*command, run);
    admin::add_setup(*command, run);
    admin::add_shutdown(*command, run);
}

void add_project(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("project", "Makes the project of a server in model mode.");
    command->require_subcommand(1);
    project::add_settings(*command, run);
    project::add_models(*command, run);
    project::add_instances(*command, run);
    project::add_mapping(*command, run);
    project::add_roles(*command, run);
    project::add_check(*command, run);
    project::add_compare(*command, run);
    project::add_online(*command, run);
}

void add_completion(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("completion", "Prints a script for completion in a shell.");
    command->footer("For this shell: eval \"$(busbar completion bash)\"\n"
                    "It completes commands, options and their values, names of profiles, and, by\n"
                    "asking the server that the line names, nodes and values of enumerations.");
    const auto shell = std::make_shared<std::string>();
    command->add_option("SHELL", *shell, "bash, zsh or fish")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh", "fish"}));
    when_chosen(*command, run, [shell](Context& context) {
        context.out.write(command_line::completion_script("busbar", *shell));
        return Exit::Good;
    });
}

} // namespace busbar::tool
