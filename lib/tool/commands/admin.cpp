#include "commands.hpp"

#include "tool/admin/commands.hpp"

namespace busbar::tool {

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

} // namespace busbar::tool
