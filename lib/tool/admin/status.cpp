#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/machine_status.hpp>
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

/// Reads a fact about a busbar-controller (W588, 4-2-1) in its own namespace.
Variant fact(Connection& connection, const char* name)
{
    return read(connection, NodeId{1, String{"Status/" + std::string{name}}});
}

std::vector<std::string> texts_of(const Variant& value)
{
    std::vector<std::string> all;
    if (const auto* const list = value.array_if<String>()) {
        for (const String& each : *list) {
            all.push_back(each.str());
        }
    }
    return all;
}

controller::OperatingStatus operating_status(const std::string& text)
{
    using controller::OperatingStatus;
    for (const OperatingStatus each :
         {OperatingStatus::Initializing, OperatingStatus::Preparing, OperatingStatus::Running,
          OperatingStatus::HaltError, OperatingStatus::Shutdown}) {
        if (controller::text(each) == text) {
            return each;
        }
    }
    return OperatingStatus::NotStarted;
}

controller::MachineStatus machine_status(Connection& connection, const std::string& operating)
{
    return {.is_used = fact(connection, "Use").value_or<bool>(false),
            .operating = operating_status(operating),
            .end_point = fact(connection, "EndPoint").value_or<String>({}).str(),
            .connected = {fact(connection, "ConnectedClients").value_or<std::uint32_t>(0),
                          fact(connection, "ConnectedUsers").value_or<std::uint32_t>(0)}};
}

/// Prints facts as lines, or as members of one object.
class Facts {
public:
    explicit Facts(Context& context) : context_{context} { json_.open_object(); }

    void add(std::string_view name, const std::string& text)
    {
        json_.member(name, text);
        line(name, text);
    }
    /// Adds a line for each text; `none` if there are none.
    void add(std::string_view name, const std::vector<std::string>& texts, const char* none)
    {
        json_.key(name).texts(texts);
        if (texts.empty()) {
            line(name, none);
        }
        for (const std::string& each : texts) {
            line(&each == &texts.front() ? name : "", each);
        }
    }
    void end()
    {
        json_.close_object();
        if (context_.options.is_json) {
            context_.out.line(json_.document());
        }
    }

private:
    void line(std::string_view name, const std::string& text)
    {
        if (context_.options.is_json) {
            return;
        }
        constexpr std::size_t width = 29; // "Number of connected clients: "
        std::string front = name.empty() ? "" : std::string{name} + ":";
        front.resize(width, ' ');
        const std::size_t columns = std::max(context_.out.columns(), 2 * width);
        context_.out.line(front + wrap(safe(text), columns - width, width));
    }

    Context& context_;
    JsonLine json_;
};

void add_machine_status(Connection& connection, const std::string& operating, Facts& facts)
{
    for (const auto& [name, value] : status_lines(machine_status(connection, operating))) {
        facts.add(name, value);
    }
    facts.add("Connected users", texts_of(fact(connection, "ConnectedUserNames")), "none");
    if (const auto why = fact(connection, "HaltReason").value_or<String>({}); !why.view().empty()) {
        facts.add("Halted because of", why.str());
    }
    facts.add("Restart due", texts_of(fact(connection, "RestartReasons")), "no");
    facts.add("Pending changes", texts_of(fact(connection, "PendingChanges")), "none");
    facts.add("Current errors", texts_of(fact(connection, "CurrentErrors")), "none");
}

Exit status_of(Context& context, Connection& connection, const AdminArguments&)
{
    const auto value = [&](std::uint32_t node) { return read(connection, standard(node)); };
    const std::string operating = fact(connection, "OperatingStatus").value_or<String>({}).str();
    const Variant sessions =
        value(id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSessionCount);
    if (operating.empty() && sessions.is_null()) {
        throw Failure{status::Bad_UserAccessDenied, "the server's status",
                      "it is for users with the role Operator, Supervisor, Engineer, "
                      "ConfigureAdmin or SecurityAdmin"};
    }
    Facts facts{context};
    if (!operating.empty()) {
        add_machine_status(connection, operating, facts);
    }
    const auto users = value(id::UserManagement_Users);
    facts.add("state", name_of(value(id::Server_ServerStatus_State).value_or<std::int32_t>(-1)));
    facts.add("service level", number(value(id::Server_ServiceLevel)));
    facts.add("clients", number(sessions));
    facts.add("started",
              to_string(value(id::Server_ServerStatus_StartTime).value_or<DateTime>({})));
    facts.add("users", users.is_null() ? "not told" : std::to_string(users.array_size()));
    facts.add("auditing", value(id::Server_Auditing).value_or<bool>(false) ? "on" : "off");
    facts.end();
    return Exit::Good;
}

Exit reset(Context& context, Connection& connection, const AdminArguments& arguments)
{
    make_sure(context, arguments,
              "Forget all certificates, users, roles and settings, and start the server again?");
    const NodeId configuration = standard(id::ServerConfiguration);
    call(connection, configuration, child_of(connection, configuration, "ResetToServerDefaults"),
         {}, "resetting the server to its defaults");
    return report(context, "all that was changed online is forgotten; the server starts again in "
                           "some seconds as it is configured on the machine, with another "
                           "certificate, and trusts only clients that it is told to trust there, "
                           "or that have its setup code");
}

} // namespace

Exit shut_down(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const bool restarts = arguments.restarts;
    const bool goes_on = fact(connection, "GoesOnWithoutServer").value_or<bool>(false);
    make_sure(context, arguments,
              restarts  ? "Restart the server?"
              : goes_on ? "Stop the server, until a restart?"
                        : "Stop the server, and the controller with it?");
    call(connection, standard(id::Server), standard(id::Server_RequestServerStateChange),
         {Variant{
              static_cast<std::int32_t>(restarts ? ServerState::Running : ServerState::Shutdown)},
          Variant{DateTime{}}, Variant{static_cast<std::uint32_t>(arguments.seconds)},
          Variant{LocalizedText{"", arguments.reason}}, Variant{restarts}},
         restarts ? "restarting the server" : "stopping the server");
    const std::string when = " in " + std::to_string(arguments.seconds) + " s";
    if (restarts) {
        return report(context, "the server restarts" + when);
    }
    return report(context, "the server stops" + when +
                               (goes_on ? ", and the controller's program goes on; `busbar admin "
                                          "shutdown --restart`, or `busbar project restart`, "
                                          "starts the server again"
                                        : ", and the controller ends"));
}

void add_status(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    group.add("status", "Shows the state of the server.", 0, "URL", status_of);
}

void add_shutdown(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    auto& arguments = group.arguments();
    constexpr unsigned max_seconds = 86'400;
    auto* command = group.add(
        "shutdown", "Stops the server; a machine's program goes on, another controller ends.", 0,
        "URL", shut_down);
    command->add_option("--seconds", arguments.seconds, "how long clients are told before")
        ->check(CLI::Range(0U, max_seconds))
        ->capture_default_str();
    command->add_option("--reason", arguments.reason, "what clients are told");
    command->add_flag("--restart", arguments.restarts, "start the server again, with its settings");
    command->add_flag("--yes", arguments.is_sure, "do not ask");
    group
        .add("reset", "Forgets certificates, users, roles and settings, and starts again.", 0,
             "URL", reset)
        ->add_flag("--yes", arguments.is_sure, "do not ask");
}

} // namespace busbar::tool::admin
