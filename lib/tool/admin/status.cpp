#include <string>

#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool::admin {

namespace {

const char* name_of(std::int32_t state)
{
    switch (static_cast<ServerState>(state)) {
    case ServerState::Running:
        return "Running";
    case ServerState::Shutdown:
        return "Shutdown";
    case ServerState::Suspended:
        return "Suspended";
    case ServerState::Failed:
        return "Failed";
    default:
        return "another";
    }
}

std::string number(const Variant& value)
{
    if (const auto* const small = value.get_if<std::uint8_t>()) {
        return std::to_string(*small);
    }
    if (const auto* const large = value.get_if<std::uint32_t>()) {
        return std::to_string(*large);
    }
    return "not told";
}

Exit status_of(Context& context, Connection& connection, const AdminArguments&)
{
    const auto value = [&](std::uint32_t node) { return read(connection, standard(node)); };
    const auto users = value(id::UserManagement_Users);
    const std::vector<std::pair<const char*, std::string>> facts{
        {"state", name_of(value(id::Server_ServerStatus_State).value_or<std::int32_t>(-1))},
        {"service level", number(value(id::Server_ServiceLevel))},
        {"clients",
         number(value(id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSessionCount))},
        {"started", to_string(value(id::Server_ServerStatus_StartTime).value_or<DateTime>({}))},
        {"users", users.is_null() ? "not told" : std::to_string(users.array_size())},
        {"auditing", value(id::Server_Auditing).value_or<bool>(false) ? "on" : "off"},
    };
    JsonLine json;
    json.open_object();
    for (const auto& [name, text] : facts) {
        json.member(name, text);
        if (!context.options.is_json) {
            constexpr std::size_t width = 15;
            std::string line = std::string{name} + ":";
            line.resize(width, ' ');
            context.out.line(line + safe(text));
        }
    }
    json.close_object();
    if (context.options.is_json) {
        context.out.line(json.document());
    }
    return Exit::Good;
}

Exit reset(Context& context, Connection& connection, const AdminArguments& arguments)
{
    make_sure(context, arguments,
              "Forget all certificates, users, roles and settings, and stop the server?");
    const NodeId configuration = standard(id::ServerConfiguration);
    call(connection, configuration, child_of(connection, configuration, "ResetToServerDefaults"),
         {}, "resetting the server to its defaults");
    return report(context, "the server stops, and starts as it was configured on the machine");
}

} // namespace

Exit shut_down(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const bool restarts = arguments.restarts;
    make_sure(context, arguments, restarts ? "Restart the server?" : "Stop the server?");
    call(connection, standard(id::Server), standard(id::Server_RequestServerStateChange),
         {Variant{
              static_cast<std::int32_t>(restarts ? ServerState::Running : ServerState::Shutdown)},
          Variant{DateTime{}}, Variant{static_cast<std::uint32_t>(arguments.seconds)},
          Variant{LocalizedText{"", arguments.reason}}, Variant{restarts}},
         restarts ? "restarting the server" : "stopping the server");
    return report(context, std::string{"the server "} + (restarts ? "restarts" : "stops") + " in " +
                               std::to_string(arguments.seconds) + " s");
}

void add_status(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    group.add("status", "Says how the server is.", 0, "URL", status_of);
}

void add_shutdown(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    auto& arguments = group.arguments();
    constexpr unsigned max_seconds = 86'400;
    auto* command = group.add("shutdown", "Stops the server.", 0, "URL", shut_down);
    command->add_option("--seconds", arguments.seconds, "how long clients are told before")
        ->check(CLI::Range(0U, max_seconds))
        ->capture_default_str();
    command->add_option("--reason", arguments.reason, "what clients are told");
    command->add_flag("--restart", arguments.restarts, "have it start again, with its settings");
    command->add_flag("--yes", arguments.is_sure, "do not ask");
    group
        .add("reset", "Forgets certificates, users, roles and settings, and stops the server.", 0,
             "URL", reset)
        ->add_flag("--yes", arguments.is_sure, "do not ask");
}

} // namespace busbar::tool::admin
