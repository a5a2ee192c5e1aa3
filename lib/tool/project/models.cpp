#include <filesystem>
#include <set>

#include <busbar/controller/mappable_parts.hpp>
#include <busbar/controller/project_models.hpp>
#include <busbar/core/text.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "reports.hpp"
#include "tool/nodes/names.hpp"
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
    const auto imported =
        models.import({name, read_file(file, controller::ProjectLimits{}.max_model_size)});
    if (!imported) {
        print_reports(context, imported.error());
        throw Failure{Exit::Failed, name + ": not imported", "the project is as it was"};
    }
    controller::keep_models(models, project);
    save_project(path, project);
    print_reports(context, imported->reports);
    return say_done(context, (imported->is_replacement ? "replaced " : "imported ") +
                                 safe(imported->uri) + ": " + std::to_string(imported->node_count) +
                                 " nodes");
}

/// The default file is named after the namespace (seed 001, 9.4).
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
        words.size() > 2 ? words[2] : controller::default_file_name(words[1]) + ".xml";
    make_room(context, file, arguments.is_sure);
    write_file(file, *text);
    return say_done(context, "exported " + safe(words[1]) + " to " + safe(file));
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
    return say_done(context, "deleted " + safe(arguments.words[1]));
}

const char* name_of(controller::ModelState state)
{
    return state == controller::ModelState::Imported ? "imported" : "another version";
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
            required +=
                (required.empty() ? "" : ", ") + safe(other.uri) +
                (other.state == controller::ModelState::Imported ? "" : " (another version)");
        }
        table.add({{std::to_string(each.index)},
                   {safe(each.uri)},
                   {safe(each.version)},
                   {safe(each.publication_date).substr(0, 10)},
                   {required,
                    each.state == controller::ModelState::Imported ? Style::Plain : Style::Bad}});
    }
    if (context.options.is_json) {
        context.out.line(json.close_array().document());
    } else {
        table.print(context.out);
    }
    return Exit::Good;
}

/// The nodes of the models below Objects, each where it is found first.
class TreeLister {
public:
    TreeLister(const ModelSet& models, bool has_parts)
        : models_{models}, space_{models.space()}, parts_{models}, has_parts_{has_parts}
    {
    }

    void list(model::NodeIndex node, std::size_t level);
    void print(Context& context)
    {
        if (context.options.is_json) {
            context.out.line(json_.close_array().document());
        } else {
            table_.print(context.out);
        }
    }

private:
    static constexpr std::size_t max_levels = 100;

    void add(model::NodeIndex node, std::size_t level);
    void add_parts(model::NodeIndex node, std::size_t level);
    void write_facts(model::NodeIndex node);
    [[nodiscard]] std::string definition_of(model::NodeIndex node) const;
    [[nodiscard]] std::string mapping_of(const NodeId& id) const;
    [[nodiscard]] std::string type_of(model::NodeIndex node) const;

    const ModelSet& models_;
    const model::SpaceReader& space_;
    controller::MappableParts parts_;
    bool has_parts_;
    std::set<model::NodeIndex> seen_;
    JsonLine json_{std::move(JsonLine{}.open_array())};
    Table table_{{{"NODE", 24},
                  {"CLASS"},
                  {"DATATYPE", 10},
                  {"NODEID", 12},
                  {"ACCESS", 2},
                  {"TYPE", 10},
                  {"MAPPING", 12}}};
};

std::string TreeLister::mapping_of(const NodeId& id) const
{
    const controller::Mapping& mapping = models_.mapping();
    const auto several = [](std::size_t labels) { return std::to_string(labels) + " labels"; };
    if (const auto found = mapping.variables.find(id); found != mapping.variables.end()) {
        const controller::MappedPart& value = found->second.value;
        const std::size_t labels = controller::count_labels(value);
        return !value.label.empty() ? value.label : labels > 0 ? several(labels) : "";
    }
    const auto found = mapping.methods.find(id);
    return found != mapping.methods.end() ? several(controller::count_labels(found->second)) : "";
}

/// "rw", of a Variable.
std::string access_of(const model::SpaceReader& space, model::NodeIndex node)
{
    if (space.node_class(node) != NodeClass::Variable) {
        return {};
    }
    const auto level = static_cast<unsigned>(space.variable(node).access_level);
    return std::string{(level & 1U) != 0 ? "r" : "-"} + ((level & 2U) != 0 ? "w" : "-");
}

/// "Int16[3]", as the tool of seed 001 shows it (9.5).
std::string TreeLister::type_of(model::NodeIndex node) const
{
    if (space_.node_class(node) != NodeClass::Variable) {
        return {};
    }
    const model::VariableAttributes variable = space_.variable(node);
    const model::NodeIndex type = space_.find(space_.data_type_id(node));
    std::string text =
        type != model::no_node ? std::string{space_.browse_name(type).name.view()} : "?";
    if (variable.value_rank < 0 && variable.value_rank != -1) {
        return text + "[-]";
    }
    for (std::int32_t i = 0; i < variable.value_rank; ++i) {
        const auto dimension = static_cast<std::size_t>(i);
        const bool is_known = dimension < variable.array_dimensions.size();
        text += "[" + (is_known ? std::to_string(variable.array_dimensions[dimension]) : "") + "]";
    }
    return text;
}

void TreeLister::add(model::NodeIndex node, std::size_t level)
{
    const NodeId id = space_.node_id(node);
    const std::string shown = to_string(space_.browse_name(node));
    const std::string_view node_class = name(space_.node_class(node));
    const std::string type = type_of(node);
    const std::string mapping = mapping_of(id);
    json_.open_object().member("level", static_cast<std::int64_t>(level)).member("name", shown);
    json_.member("nodeId", to_string(id)).member("nodeClass", node_class);
    json_.member("dataType", type).member("mapping", mapping);
    write_facts(node);
    json_.close_object();
    table_.add({{std::string(2 * level, ' ') + safe(shown)},
                {std::string{node_class}},
                {safe(type)},
                {safe(to_string(id))},
                {access_of(space_, node)},
                {safe(definition_of(node))},
                {safe(mapping)}});
    if (has_parts_) {
        add_parts(node, level + 1);
    }
}

/// What else the tool of seed 001 shows of a node (9.4).
void TreeLister::write_facts(model::NodeIndex node)
{
    json_.member("displayName", space_.display_name(node).text.view());
    const auto descriptions = space_.texts(node, AttributeId::Description);
    json_.member("description", descriptions.empty() ? "" : descriptions.front().text.view());
    json_.member("typeDefinition", definition_of(node));
    if (space_.node_class(node) == NodeClass::Variable) {
        const model::VariableAttributes variable = space_.variable(node);
        json_.member("valueRank", static_cast<std::int64_t>(variable.value_rank));
        json_.member("accessLevel", static_cast<std::int64_t>(variable.access_level));
    }
}

/// Fields, elements, the Handle and arguments, unless the node itself is all that can be mapped.
void TreeLister::add_parts(model::NodeIndex node, std::size_t level)
{
    for (const controller::MappablePart& part : parts_.of(node)) {
        if (part.path.empty()) {
            continue;
        }
        json_.open_object().member("level", static_cast<std::int64_t>(level));
        json_.member("part", part.path).member("dataType", part.type);
        json_.member("mapping", part.label).close_object();
        table_.add({{std::string(2 * level, ' ') + safe(part.path)},
                    {""},
                    {safe(part.type)},
                    {""},
                    {""},
                    {""},
                    {safe(part.label)}});
    }
}

std::string TreeLister::definition_of(model::NodeIndex node) const
{
    const model::NodeIndex type = space_.type_definition(node);
    return type != model::no_node ? std::string{space_.browse_name(type).name.view()} : "";
}

void TreeLister::list(model::NodeIndex node, std::size_t level)
{
    if (level > max_levels || !seen_.insert(node).second) {
        return;
    }
    add(node, level);
    auto cursor = space_.references(node);
    while (const auto reference = cursor.next()) {
        const bool leads_down = reference->is_forward &&
                                space_.is_subtype_of(reference->type, id::HierarchicalReferences) &&
                                space_.node_id(reference->target).namespace_index() != 0;
        if (leads_down) {
            list(reference->target, level + 1);
        }
    }
}

Exit show_tree(Context& context, const ProjectArguments& arguments)
{
    const ModelSet models = open_models(open_project(arguments.words[0]));
    TreeLister tree{models, arguments.wants_all};
    tree.list(models.space().find(id::ObjectsFolder), 0);
    tree.print(context);
    return Exit::Good;
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
                2, 2, "FILE NODESET", import_model, arguments);
    add_offline(project, run, "export", "Writes a namespace with its mapping as a NodeSet2 file.",
                2, 3, "FILE URI [NODESET]", export_model, arguments)
        ->add_flag("--yes", arguments->is_sure, "replace a file without a question");
    add_offline(project, run, "delete", "Takes away the last namespace.", 2, 2, "FILE URI",
                delete_model, arguments);
    add_offline(project, run, "namespaces", "Lists the namespaces and what they require.", 1, 1,
                "FILE", list_namespaces, arguments);
    add_offline(project, run, "tree", "Lists the nodes of the models and what is mapped.", 1, 1,
                "FILE", show_tree, arguments)
        ->add_flag("--parts", arguments->wants_all,
                   "also elements (\"[0]\"), fields (\".A\", \"[0].A\"), and of Methods \"Handle\" "
                   "and \"Input[0]\"");
}

} // namespace busbar::tool::project
