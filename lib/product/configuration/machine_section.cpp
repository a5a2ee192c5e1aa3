#include "sections.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/controller/machine_event.hpp>

#include "core/ascii_case.hpp"
#include "limit_keys.hpp"
#include "product/machine/program_file.hpp"

namespace busbar::product {

namespace {

/// Reads the DataTypes of variables, if they differ from the preset's.
void read_types(const TomlTable& table, MachineConfig& machine)
{
    controller::MachineTypeOptions& types = machine.types;
#ifdef BUSBAR_HAS_PLCOPEN
    constexpr const char* expected = "\"plcopen\" or \"built-in\"";
#else
    constexpr const char* expected = "\"built-in\", as this build does not include PLCopen";
#endif
    const std::string name = table.text("types", "");
    if (name == "built-in") {
        types.elementary = controller::ElementaryTypes::BuiltIn;
#ifdef BUSBAR_HAS_PLCOPEN
    } else if (name == "plcopen") {
        types = controller::MachineTypeOptions{};
#endif
    } else if (!name.empty()) {
        table.fail("types", expected);
    }
    const bool has_types = types.elementary == controller::ElementaryTypes::Plcopen;
    machine.has_plcopen = table.flag("plcopen_model", has_types || machine.has_plcopen);
    if (has_types && !machine.has_plcopen) {
        table.refuse("plcopen_model", "found false where types are \"plcopen\", expected true");
    }
#ifndef BUSBAR_HAS_PLCOPEN
    if (machine.has_plcopen && table.has("plcopen_model")) {
        table.refuse("plcopen_model",
                     "found true, expected false, as this build does not include PLCopen");
    }
#endif
}

/// Parses "15000000 observation": the code as in the event log, and the level.
std::optional<controller::EventLevelChoice> find_event_level(std::string_view text)
{
    for (const controller::MachineEventType& type : controller::machine_event_types()) {
        for (const auto level : {std::optional{type.level}, type.other_level}) {
            const std::string choice =
                level ? code_text(type) + " " + std::string{name(*level)} : std::string{};
            if (type.other_level && busbar::detail::is_same_ignoring_case(choice, text)) {
                return controller::EventLevelChoice{type.code, *level};
            }
        }
    }
    return std::nullopt;
}

std::vector<controller::EventLevelChoice> read_event_levels(const TomlTable& table)
{
    std::vector<controller::EventLevelChoice> levels;
    if (!table.has("event_levels")) {
        return levels;
    }
    for (const std::string& text : table.texts("event_levels")) {
        const auto level = find_event_level(text);
        if (!level) {
            std::string choices;
            for (const controller::MachineEventType& type : controller::machine_event_types()) {
                if (type.other_level) {
                    choices += (choices.empty() ? "\"" : ", \"") + code_text(type) + " " +
                               std::string{name(*type.other_level)} + "\"";
                }
            }
            table.fail("event_levels", "some of " + choices + ", or the level that each has");
        }
        levels.push_back(*level);
    }
    return levels;
}

} // namespace

controller::MachineTypeOptions default_types()
{
#ifdef BUSBAR_HAS_PLCOPEN
    return {};
#else
    return {.elementary = controller::ElementaryTypes::BuiltIn};
#endif
}

void read_machine(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"program", "name", "use", "mode", "state", "medium", "execution_log",
                 "execution_log_files", "execution_log_records", "retained_ms", "types",
                 "simulated_hardware", "event_levels", "make_medium", "plcopen_model", "strict",
                 "encoding"});
    MachineConfig& machine = config.machine;
    machine.program_file = read_program_path(table, "program");
    machine.name = table.text("name", "");
    if (!machine.name.empty()) {
        check_name(table, "name", machine.name);
    }
    machine.state_folder = table.text("state", machine.state_folder);
    machine.medium_folder = table.text("medium", machine.medium_folder);
    machine.makes_medium = table.flag("make_medium", true);
    const std::string mode = table.text("mode", "RUN");
    if (mode != "RUN" && mode != "PROGRAM") {
        table.fail("mode", "\"RUN\" or \"PROGRAM\"");
    }
    machine.mode = mode == "RUN" ? controller::MachineMode::Run : controller::MachineMode::Program;
    machine.simulates_hardware = table.flag("simulated_hardware", false);
    machine.execution_log.is_recorded = table.flag("execution_log", false);
    machine.event_levels = read_event_levels(table);
    read_numbers(table, "machine", config);
    read_types(table, machine);
    // As the rest, it means nothing without a program.
    machine.is_used = table.flag("use", true) || machine.program_file.empty();
    if (machine.program_file.empty()) {
        return;
    }
    machine.reading = read_reading(table);
    machine.may_leave_out_more =
        table.has("strict") && machine.reading.unserved == controller::Unserved::LeaveOut;
    auto file = read_machine_program(table, "program");
    machine.program_text = std::move(file.text);
    machine.program = std::move(file.program);
    machine.program_name = std::move(file.name);
}

} // namespace busbar::product
