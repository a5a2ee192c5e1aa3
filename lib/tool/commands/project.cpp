#include "commands.hpp"

#include "tool/project/commands.hpp"

namespace busbar::tool {

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

} // namespace busbar::tool
