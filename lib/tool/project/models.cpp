#include <filesystem>

#include <busbar/controller/project_models.hpp>
#include <busbar/core/text.hpp>

#include "commands.hpp"
#include "tool/admin/commands.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

using controller::ModelSet;

Exit import_model(Context& context, const ProjectArguments& arguments)
{
    const auto& [path, file] = std::tie(arguments.words[0], arguments.words[1]);
    controller::Project project = open_project(path);
    ModelSet models = open_models(project);
    const std::string name = std::filesystem::path{file}.filename().string();
    const auto imported = models.import(
        {name, read_file(file, controller::ProjectLimits{}.max_model_size), arguments.is_lenient});
    if (!imported) {
        print_reports(context, imported.error());
        throw Failure{Exit::Failed, name + ": not imported",
                      arguments.is_lenient
                          ? "the project is as it was"
                          : "the project is as it was; --lenient repairs what files of vendors "
                            "often have wrong"};
    }
    controller::keep_models(models, project);
    save_project(path, project);
    print_reports(context, imported->reports);
    for (const std::string& line : imported->repairs) {
        context.warn("repaired", line);
    }
    const Exit done = admin::report(
        context, (imported->is_replacement ? "replaced " : "imported ") + safe(imported->uri) +
                     ": " + std::to_string(imported->node_count) + " nodes");
    return imported->reports.has_errors() ? Exit::Partly : done;
}

/// Named after the namespace, with "_1", "_2" and so on where a file of that name is there and is
/// not replaced (SH-082679, 9.4).
std::string default_file(const std::string& uri, bool replaces)
{
    std::vector<std::string> taken;
    std::string name = controller::default_file_name(uri);
    std::error_code ignored;
    while (!replaces && std::filesystem::exists(name + ".xml", ignored)) {
        taken.push_back(std::move(name));
        name = controller::default_file_name(uri, taken);
    }
    return name + ".xml";
}

Exit export_model(Context& context, const ProjectArguments& arguments)
{
    const auto& words = arguments.words;
    const ModelSet models = open_models(open_project(words[0]));
    const auto text = models.export_text(words[1]);
    if (!text) {
        throw Failure{Exit::Failed, controller::text(text.error()),
                      "`busbar project namespaces` lists them"};
    }
    const std::string file =
        words.size() > 2 ? words[2] : default_file(words[1], arguments.is_sure);
    make_room(context, file, arguments.is_sure);
    write_file(file, *text);
    return admin::report(context, "exported " + safe(words[1]) + " to " + safe(file));
}

Exit delete_model(Context& context, const ProjectArguments& arguments)
{
    controller::Project project = open_project(arguments.words[0]);
    ModelSet models = open_models(project);
    if (const auto removed = models.remove(arguments.words[1]); !removed) {
        throw Failure{Exit::Failed, text(removed.error()),
                      "only the last one of `busbar project namespaces` can be deleted"};
    }
    controller::keep_models(models, project);
    save_project(arguments.words[0], project);
    return admin::report(context, "deleted " + safe(arguments.words[1]));
}

const char* name_of(controller::ModelState state)
{
    switch (state) {
    case controller::ModelState::Imported:
        return "imported";
    case controller::ModelState::LaterVersion:
        return "a later version";
    case controller::ModelState::OtherVersion:
        break;
    }
    return "another version";
}

void write_model(JsonLine& json, const controller::ModelNamespace& each)
{
    json.open_object().member("index", static_cast<std::int64_t>(each.index));
    json.member("uri", each.uri).member("version", each.version);
    json.member("publicationDate", each.publication_date).member("state", name_of(each.state));
    json.key("required").open_array();
    for (const controller::RequiredModelStatus& required : each.required) {
        json.open_object().member("uri", required.uri).member("version", required.version);
        json.member("publicationDate", required.publication_date);
        json.member("state", name_of(required.state)).close_object();
    }
    json.close_array().close_object();
}

Exit list_namespaces(Context& context, const ProjectArguments& arguments)
{
    const ModelSet models = open_models(open_project(arguments.words[0]));
    JsonLine json;
    json.open_array();
    Table table{
        {{"INDEX", 5, true}, {"URI", 24}, {"VERSION"}, {"PUBLISHED", 10}, {"REQUIRES", 16}}};
    for (const controller::ModelNamespace& each : models.namespaces()) {
        write_model(json, each);
        std::string required;
        for (const controller::RequiredModelStatus& other : each.required) {
            required += (required.empty() ? "" : ", ") + safe(other.uri);
            if (other.state != controller::ModelState::Imported) {
                required += safe(" (of " + other.version + ", published " + other.publication_date +
                                 ", and here is " + name_of(other.state) + ")");
            }
        }
        table.add({{std::to_string(each.index)},
                   {safe(each.uri)},
                   {safe(each.version)},
                   {safe(each.publication_date).substr(0, 10)},
                   {required, each.state == controller::ModelState::OtherVersion ? Style::Bad
                                                                                 : Style::Plain}});
    }
    return print_rows(context, json.close_array(), table);
}

} // namespace

controller::ModelSet open_models(const controller::Project& project)
{
    auto models = controller::load_models(project);
    if (!models) {
        throw Failure{Exit::Failed, text(models.error()), "the project's models cannot be loaded"};
    }
    return *std::move(models);
}

void print_reports(Context& context, const controller::ModelReports& reports)
{
    for (const controller::ModelReport& report : reports.list()) {
        context.warn(controller::rule_of(report.code).result == controller::ReportResult::Error
                         ? "error"
                         : "warning",
                     safe(text(report)));
    }
}

void add_models(CLI::App& project, Run& run)
{
    const auto arguments = std::make_shared<ProjectArguments>();
    add_offline(project, run, "import", "Adds a NodeSet2 file, or replaces that of its namespace.",
                2, 2, "FILE NODESET", import_model, arguments)
        ->add_flag("--lenient", arguments->is_lenient,
                   "repair what files of vendors often have wrong, and list it");
    add_offline(project, run, "export", "Writes a namespace with its mapping as a NodeSet2 file.",
                2, 3, "FILE URI [NODESET]", export_model, arguments)
        ->add_flag("--yes", arguments->is_sure, "replace a file without a question");
    add_offline(project, run, "delete", "Takes away the last namespace.", 2, 2, "FILE URI",
                delete_model, arguments);
    add_offline(project, run, "namespaces", "Lists the namespaces and what they require.", 1, 1,
                "FILE", list_namespaces, arguments);
    auto* tree =
        add_offline(project, run, "tree", "Lists the nodes of the models and what is mapped.", 1, 1,
                    "FILE", show_tree, arguments);
    tree->add_flag("--parts", arguments->has_parts,
                   "also elements (\"[0]\"), fields (\".A\", \"[0].A\"), and of Methods \"Handle\" "
                   "and \"Input[0]\"");
    tree->add_flag("--all", arguments->wants_all, "the same with all columns and all arguments");
}

} // namespace busbar::tool::project
