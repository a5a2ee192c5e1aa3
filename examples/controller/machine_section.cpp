#include "machine_section.hpp"

#include <filesystem>
#include <fstream>
#include <utility>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/plcopen_xml.hpp>

namespace busbar::example {

namespace {

constexpr std::string_view xml_ending = ".xml";

std::string read_program_file(const TomlTable& table, const std::string& path)
{
    const controller::DeclarationLimits limits;
    std::ifstream file{path, std::ios::binary | std::ios::ate};
    const auto size = file ? static_cast<std::streamoff>(file.tellg()) : std::streamoff{-1};
    if (size < 0 || std::filesystem::is_directory(path)) {
        table.fail("program", "a file of declarations (IEC 61131-3) or PLCopen XML");
    }
    if (static_cast<std::uint64_t>(size) > limits.max_text_size) {
        table.fail("program",
                   "a file of at most " + std::to_string(limits.max_text_size) + " bytes");
    }
    std::string text(static_cast<std::size_t>(size), '\0');
    file.seekg(0);
    file.read(text.data(), size);
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text;
}

controller::Program read_program(const std::string& text, const std::string& path)
{
    if (path.ends_with(xml_ending)) {
        return expect(controller::read_plcopen_xml(text, path));
    }
    return expect(controller::read_declarations(text, path));
}

void read_execution_log(const TomlTable& table, controller::ExecutionLogSettings& log)
{
    log.is_recorded = table.flag("execution_log", false);
    log.files = static_cast<std::uint32_t>(table.integer("execution_log_files", log.files, 2, 100));
    log.records = static_cast<std::uint32_t>(
        table.integer("execution_log_records", log.records, 100, 65'536));
}

/// A problem of the program as a whole has no file yet.
Problem in_file(Problem problem, const std::string& file)
{
    problem.where = problem.where.empty() ? file : file + ":" + problem.where;
    return problem;
}

} // namespace

std::unique_ptr<controller::PublishedProgram> publish_program(const ControllerConfig& config)
{
    const MachineConfig& machine = config.machine;
    return expect(controller::PublishedProgram::create(*machine.program, machine.publishing)
                      .map_error([&](Problem problem) {
                          return in_file(std::move(problem), machine.program_file);
                      }));
}

void read_machine(const TomlTable& table, ControllerConfig& config)
{
    table.allow({"program", "name", "mode", "state", "medium", "execution_log",
                 "execution_log_files", "execution_log_records", "retained_ms"});
    MachineConfig& machine = config.machine;
    machine.program_file = table.text("program", "");
    machine.name = table.text("name", "");
    machine.state_folder = table.text("state", machine.state_folder);
    machine.medium_folder = table.text("medium", machine.medium_folder);
    const std::string mode = table.text("mode", "RUN");
    if (mode != "RUN" && mode != "PROGRAM") {
        table.fail("mode", "\"RUN\" or \"PROGRAM\"");
    }
    machine.mode = mode == "RUN" ? controller::MachineMode::Run : controller::MachineMode::Program;
    read_execution_log(table, machine.execution_log);
    machine.retained = std::chrono::milliseconds{
        table.integer("retained_ms", machine.retained.count(), 100, 3'600'000)};
    if (machine.program_file.empty()) {
        return;
    }
    machine.program_text =
        std::make_shared<const std::string>(read_program_file(table, machine.program_file));
    machine.program = std::make_shared<const controller::Program>(
        read_program(*machine.program_text, machine.program_file));
    static_cast<void>(publish_program(config));
}

} // namespace busbar::example
