#include "status.hpp"

#include <set>
#include <string_view>
#include <utility>

#include <busbar/controller/machine_status.hpp>
#include <busbar/server/running_server.hpp>

namespace busbar::product {

namespace {

Variant texts(const std::vector<std::string>& all)
{
    Array<String> list;
    list.clear(); // not null
    for (const std::string& each : all) {
        list.push_back(String{each});
    }
    return Variant{std::move(list)};
}

controller::OperatingStatus operating_status(const StatusSources& sources)
{
    using controller::OperatingStatus;
    if (sources.machine != nullptr) {
        return sources.machine->life().operating_status();
    }
    if (sources.is_shut_down) {
        return OperatingStatus::Shutdown;
    }
    switch (server::RunningServer{sources.server}.state()) {
    case ServerState::Running:
        return OperatingStatus::Running;
    case ServerState::Shutdown:
        return OperatingStatus::Shutdown;
    default:
        return OperatingStatus::HaltError;
    }
}

/// Lists each user once, however many sessions the user has.
std::vector<std::string> user_names(server::Server& server)
{
    std::set<std::string> names;
    server::RunningServer{server}.visit_users([&](const server::UserIdentity& user) {
        names.insert(user.name.empty() ? "Anonymous" : user.name);
    });
    return {names.begin(), names.end()};
}

std::vector<std::string> waiting_settings(const Settings& settings)
{
    std::vector<std::string> names;
    for (const administration::Setting& each : settings.list().settings()) {
        if (settings.waits_for_restart(each)) {
            names.push_back(each.name);
        }
    }
    return names;
}

std::vector<std::string> restart_reasons(const StatusSources& sources)
{
    std::vector<std::string> reasons;
    if (sources.machine != nullptr) {
        if (const std::string_view reason = sources.machine->life().restart_reason();
            !reason.empty()) {
            reasons.emplace_back(reason);
        }
    }
    for (const std::string& name : waiting_settings(sources.settings)) {
        reasons.push_back(name + " was changed and waits for a restart");
    }
    return reasons;
}

std::vector<std::string> pending_changes(const StatusSources& sources)
{
    std::vector<std::string> all = sources.pending.reasons();
    for (const std::string& name : waiting_settings(sources.settings)) {
        all.push_back(name + ": waits for a restart");
    }
    return all;
}

std::vector<std::string> current_errors(const Machine* machine)
{
    std::vector<std::string> all;
    if (machine != nullptr) {
        for (const controller::MachineEvent& each : machine->event_log().current_errors()) {
            all.push_back(what_to_do(each));
        }
    }
    return all;
}

Variant number(std::size_t value)
{
    return Variant{static_cast<std::uint32_t>(value)};
}

} // namespace

std::vector<std::string> PendingChanges::reasons() const
{
    std::vector<std::string> all;
    for (const std::string& each : reasons_) {
        if (!each.empty()) {
            all.push_back(each);
        }
    }
    return all;
}

std::vector<administration::StatusFact> status_facts(const StatusSources& sources)
{
    const Variant text{String{""}};
    const Variant list = texts({""});
    const Variant count = number(0);
    const auto end_point = [sources] {
        return operating_status(sources) == controller::OperatingStatus::Running
                   ? sources.server.config().endpoint_url
                   : std::string{};
    };
    const auto halt_reason = [sources] {
        return sources.machine != nullptr ? sources.machine->life().halt_reason() : std::string{};
    };
    return {
        {"Use", Variant{true}, [sources] { return Variant{sources.config.machine.is_used}; }},
        {"OperatingStatus", text,
         [sources] { return Variant{String{controller::text(operating_status(sources))}}; }},
        {"EndPoint", text, [end_point] { return Variant{String{end_point()}}; }},
        {"ConnectedClients", count, [sources] { return number(sources.server.session_count()); }},
        {"ConnectedUsers", count, [sources] { return number(user_names(sources.server).size()); }},
        {"ConnectedUserNames", list, [sources] { return texts(user_names(sources.server)); }},
        {"HaltReason", text, [halt_reason] { return Variant{String{halt_reason()}}; }},
        {"RestartReasons", list, [sources] { return texts(restart_reasons(sources)); }},
        {"PendingChanges", list, [sources] { return texts(pending_changes(sources)); }},
        {"CurrentErrors", list, [sources] { return texts(current_errors(sources.machine)); }},
        {"GoesOnWithoutServer", Variant{true}, [sources] { return Variant{sources.goes_on}; }},
    };
}

} // namespace busbar::product
