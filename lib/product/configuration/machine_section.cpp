#include "sections.hpp"

#include <utility>

#include "limit_keys.hpp"
#include "product/machine/program_file.hpp"

namespace busbar::product {

namespace {

/// Which DataTypes variables have, if not those of the preset.
void read_types(const TomlTable& table, controller::MachineTypeOptions& types)
{
#ifdef BUSBAR_HAS_PLCOPEN
    constexpr const char* expected = "\"plcopen\" or \"built-in\"";
#else
    constexpr const char* expected = "\"built-in\", as PLCopen is no part of this build";
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
                 "simulated_hardware"});
    MachineConfig& machine = config.machine;
    machine.program_file = table.text("program", "");
    machine.name = table.text("name", "");
    if (!machine.name.empty()) {
        check_name(table, "name", machine.name);
    }
    machine.state_folder = table.text("state", machine.state_folder);
    machine.medium_folder = table.text("medium", machine.medium_folder);
    const std::string mode = table.text("mode", "RUN");
    if (mode != "RUN" && mode != "PROGRAM") {
        table.fail("mode", "\"RUN\" or \"PROGRAM\"");
    }
    machine.mode = mode == "RUN" ? controller::MachineMode::Run : controller::MachineMode::Program;
    machine.simulates_hardware = table.flag("simulated_hardware", false);
    machine.execution_log.is_recorded = table.flag("execution_log", false);
    read_numbers(table, "machine", config);
    read_types(table, machine.types);
    // As the rest, it means nothing without a program.
    machine.is_used = table.flag("use", true) || machine.program_file.empty();
    if (machine.program_file.empty()) {
        return;
    }
    ProgramFile file = read_machine_program(table, "program");
    machine.program_text = std::move(file.text);
    machine.program = std::move(file.program);
    machine.program_name = std::move(file.name);
}

} // namespace busbar::product
