
#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/label_check.hpp>
#include <busbar/controller/program_files.hpp>
#include <busbar/controller/program_text.hpp>

#include "commands.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

using controller::ModelReport;
using controller::ReportResult;

/// An item of the status bar or of a tooltip of it (SH-082679, 4.2).
struct Counter {
    const char* name;
    std::uint64_t count;
    std::uint64_t limit;
};

std::vector<Counter> counters_of(const controller::ModelCounters& counters,
                                 const controller::ModelLimits& limits)
{
    return {{"labels", counters.labels, limits.max_labels},
            {"characters of labels", counters.label_length, limits.max_total_label_length},
            {"words of Variables", counters.variable_words, limits.max_variable_words},
            {"Variables", counters.variables, limits.max_variables},
            {"bytes of files", counters.file_size, limits.max_file_size}};
}

const char* result_of(const ModelReport& report)
{
    return controller::rule_of(report.code).result == ReportResult::Error ? "error" : "warning";
}

std::string code_of(const ModelReport& report)
{
    return "M" + std::to_string(static_cast<int>(report.code));
}

void write_json(Context& context, const controller::ModelReports& reports,
                const std::vector<Counter>& counters)
{
    JsonLine json;
    json.open_object().key("reports").open_array();
    for (const ModelReport& report : reports.list()) {
        const controller::ReportRule& rule = controller::rule_of(report.code);
        json.open_object().member("result", result_of(report)).member("function", rule.function);
        json.member("cause", rule.category).member("where", report.where);
        json.member("content", rule.content).member("found", report.found);
        json.member("correctiveAction", rule.corrective_action);
        json.member("code", code_of(report)).close_object();
    }
    json.close_array().key("counters").open_array();
    for (const Counter& each : counters) {
        json.open_object().member("name", each.name);
        json.member("count", static_cast<std::int64_t>(each.count));
        json.member("limit", static_cast<std::int64_t>(each.limit));
        json.member("isExceeded", each.count > each.limit).close_object();
    }
    json.close_array();
    json.member("errors", static_cast<std::int64_t>(reports.error_count()));
    json.member("warnings", static_cast<std::int64_t>(reports.warning_count()));
    context.out.line(json.close_object().document());
}

void print_text(Context& context, const controller::ModelReports& reports,
                const std::vector<Counter>& counters)
{
    for (const ModelReport& report : reports.list()) {
        context.out.line(wrap(safe(controller::text(report)), context.out.columns(), 2));
    }
    Table table{{{"ITEM", 20}, {"COUNT", 8, true}, {"LIMIT", 8, true}}};
    for (const Counter& each : counters) {
        const Style style = each.count > each.limit ? Style::Bad : Style::Plain;
        table.add({{each.name}, {std::to_string(each.count), style}, {std::to_string(each.limit)}});
    }
    table.print(context.out);
    context.out.line(std::to_string(reports.error_count()) + " errors, " +
                     std::to_string(reports.warning_count()) + " warnings");
}

/// Reports the mapped labels that a PLC with the program in this file does not have.
controller::ModelReports check_program(const controller::Project& project, const std::string& file,
                                       const std::string& encoding)
{
    const auto chosen = controller::find_text_encoding(encoding);
    if (!encoding.empty() && !chosen) {
        throw Failure{Exit::Usage, "--encoding " + safe(encoding) + ": unknown",
                      "expected utf-8, utf-16, utf-16be, shift-jis or windows-1252"};
    }
    auto reports =
        controller::read_program_files(file, controller::DeclarationLimits{}.max_text_size)
            .and_then([&](const std::string& text) {
                return controller::read_program_text(
                    text, file, {}, controller::Unserved::Refuse,
                    chosen.value_or(controller::TextEncoding::Recognized));
            })
            .and_then([&](controller::Program program) {
                return controller::check_labels(open_models(project), std::move(program));
            });
    if (!reports) {
        throw Failure{Exit::Failed, busbar::text(reports.error()),
                      "expected the PLC's declarations (IEC 61131-3), PLCopen XML, IEC 61131-10, "
                      "a file of TwinCAT or a list of labels of GX Works"};
    }
    return *std::move(reports);
}

/// Does the same as the button of the output window (SH-082679, 4.2), and checks settings, too.
Exit check_project(Context& context, const ProjectArguments& arguments)
{
    const controller::Project project = open_project(arguments.words[0]);
    if (const auto checked = controller::check(project); !checked) {
        throw Failure{Exit::Failed, text(checked.error()), "see `busbar project set`"};
    }
    auto check = check_project_models(project);
    if (!arguments.program.empty()) {
        check.reports.add(check_program(project, arguments.program, arguments.encoding));
    }
    const controller::ModelReports& reports = check.reports;
    const auto counters = counters_of(check.counters, controller::model_limits(project));
    if (context.options.is_json) {
        write_json(context, reports, counters);
    } else {
        print_text(context, reports, counters);
    }
    return reports.has_errors() ? Exit::Failed : Exit::Good;
}

} // namespace

controller::MappingCheck check_project_models(const controller::Project& project)
{
    controller::ModelReports reports;
    auto models = controller::load_models(project, &reports);
    if (!models) {
        throw Failure{Exit::Failed, text(models.error()), "the project's models cannot be loaded"};
    }
    auto check = controller::check_project_mapping(project, *models);
    reports.add(std::move(check.reports));
    check.reports = std::move(reports);
    return check;
}

void add_check(CLI::App& project, Run& run)
{
    const auto arguments = std::make_shared<ProjectArguments>();
    auto* check = add_offline(project, run, "check",
                              "Lists what is wrong with a project, and how full it is.", 1, 1,
                              "FILE", check_project, arguments);
    check
        ->add_option("--program", arguments->program,
                     "declarations of a PLC, a folder or a .plcproj of such; every label must be "
                     "one of their variables")
        ->type_name("PROGRAM");
    check
        ->add_option("--encoding", arguments->encoding,
                     "of the program: utf-8, utf-16, utf-16be, shift-jis or windows-1252; else it "
                     "is recognized")
        ->type_name("NAME");
}

} // namespace busbar::tool::project
