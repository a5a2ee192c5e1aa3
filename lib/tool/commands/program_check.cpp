#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/program_files.hpp>
#include <busbar/controller/program_text.hpp>
#include <busbar/controller/publishing_limits.hpp>

#include "commands.hpp"
#include "controller/machine/program_report.hpp"
#include "tool/connection/failure.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool {

namespace {

using controller::detail::ProgramReport;

struct ProgramArguments {
    std::vector<std::string> files;
    std::string preset;
    std::string encoding;
    bool is_strict{false};
    /// All files are one program.
    bool is_one{false};
};

struct PresetLimits {
    std::string_view name;
    controller::PublishingLimits (*limits)();
};
constexpr std::array preset_limits{
    PresetLimits{"nj501", controller::nj501_publishing},
    PresetLimits{"nx102", controller::nx102_publishing},
};

controller::PublishingLimits limits_of(const std::string& preset)
{
    const auto* const found =
        std::find_if(preset_limits.begin(), preset_limits.end(),
                     [&](const PresetLimits& each) { return each.name == preset; });
    if (found != preset_limits.end()) {
        return found->limits();
    }
    if (!preset.empty()) {
        throw Failure{Exit::Usage, "--preset " + safe(preset) + ": unknown",
                      "expected nj501 or nx102"};
    }
    return {};
}

controller::TextEncoding encoding_of(const std::string& encoding)
{
    const auto chosen = controller::find_text_encoding(encoding);
    if (!encoding.empty() && !chosen) {
        throw Failure{Exit::Usage, "--encoding " + safe(encoding) + ": unknown",
                      "expected utf-8, utf-16, utf-16be, shift-jis or windows-1252"};
    }
    return chosen.value_or(controller::TextEncoding::Recognized);
}

ProgramReport report_of(const std::string& paths, const ProgramArguments& arguments)
{
    const auto unserved =
        arguments.is_strict ? controller::Unserved::Refuse : controller::Unserved::LeaveOut;
    const controller::DeclarationLimits limits;
    auto program = controller::read_program_files(paths, limits.max_text_size)
                       .and_then([&](const std::string& text) {
                           return controller::read_program_text(text, paths, limits, unserved,
                                                                encoding_of(arguments.encoding));
                       })
                       .and_then([&](controller::Program read) {
                           const bool has_files = !read.files.empty();
                           return controller::CheckedProgram::create(std::move(read), unserved)
                               .transform_error([&](Problem problem) {
                                   problem.where.insert(0, has_files ? "" : paths + ":");
                                   return problem;
                               });
                       });
    return {paths, std::move(program), limits_of(arguments.preset)};
}

/// Does the same as `busbar-controller --check`.
Exit check_program(Context& context, const ProgramArguments& arguments)
{
    std::vector<std::string> programs = arguments.files;
    if (arguments.is_one) {
        std::string all;
        for (const std::string& file : arguments.files) {
            all += (all.empty() ? "" : "\n") + file;
        }
        programs = {std::move(all)};
    }
    bool is_good = true;
    busbar::detail::JsonWriter json;
    json.begin_list();
    for (const std::string& each : programs) {
        const ProgramReport report = report_of(each, arguments);
        is_good = is_good && report.is_good();
        if (context.options.is_json) {
            report.write(json);
            continue;
        }
        for (const std::string& line : report.lines()) {
            context.out.line(safe(line));
        }
    }
    json.end_list();
    if (context.options.is_json) {
        context.out.line(json.document());
    }
    return is_good ? Exit::Good : Exit::Failed;
}

void add_file_check(CLI::App& program, Run& run)
{
    const auto arguments = std::make_shared<ProgramArguments>();
    auto* check = program.add_subcommand(
        "check", "Lists what of a PLC's program would be published, and why the rest would not.");
    check->fallthrough();
    check
        ->add_option("FILE", arguments->files,
                     "declarations (IEC 61131-3), PLCopen XML, IEC 61131-10, an object of TwinCAT, "
                     "a list of labels of GX Works, a table of Sysmac Studio; a folder or a "
                     ".plcproj of such")
        ->required();
    check
        ->add_option("--preset", arguments->preset,
                     "count against the limits of a product: nj501 or nx102")
        ->type_name("NAME");
    check
        ->add_option("--encoding", arguments->encoding,
                     "utf-8, utf-16, utf-16be, shift-jis or windows-1252; else it is recognized")
        ->type_name("NAME");
    check->add_flag("--strict", arguments->is_strict,
                    "refuse a program with a declaration that is left out");
    check->add_flag("--together", arguments->is_one, "all files are one program");
    when_chosen(*check, run, [arguments](Context& context) {
        for (std::string& file : arguments->files) {
            unmark(file);
        }
        return check_program(context, *arguments);
    });
}

} // namespace

void add_program(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("program", "Looks into the program of a PLC in its files.");
    command->require_subcommand(1);
    add_file_check(*command, run);
}

} // namespace busbar::tool
