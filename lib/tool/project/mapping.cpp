#include <algorithm>
#include <filesystem>
#include <utility>

#include <busbar/controller/mapping_check.hpp>
#include <busbar/controller/mapping_table.hpp>
#include <busbar/controller/project_models.hpp>

#include "commands.hpp"
#include "tool/admin/commands.hpp"
#include "tool/connection/server_trust.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool::project {

namespace {

using controller::MappedPart;
using controller::Mapping;
using controller::ModelSet;

/// Quotes a field of a table as RFC 4180 requires.
std::string quoted(const std::string& text)
{
    std::string field = "\"";
    for (const char c : text) {
        field += c == '"' ? "\"\"" : std::string(1, c);
    }
    return field + "\"";
}

/// The reports of a table that the command has made of its arguments, with the node as their place.
controller::ModelReports reports_of(const controller::ModelReports& reports,
                                    const std::string& node)
{
    controller::ModelReports result;
    for (controller::ModelReport each : reports.list()) {
        each.where = safe(node);
        result.add(std::move(each));
    }
    return result;
}

/// Parses a line of the table with these columns; a node is a NodeId or a path from the Root.
Mapping mapping_of(Context& context, const ModelSet& models, const std::string& node,
                   const std::string& columns, const std::string& fields)
{
    const bool is_path = node.starts_with('/');
    const auto read = controller::read_mapping_table((is_path ? "Path," : "NodeId,") + columns +
                                                         "\n" + quoted(node) + "," + fields + "\n",
                                                     models.space());
    if (read.reports.has_errors() ||
        (read.mapping.variables.empty() && read.mapping.methods.empty())) {
        print_reports(context, reports_of(read.reports, node));
        throw Failure{
            Exit::Failed, safe(node) + ": not mapped",
            "`busbar project tree` lists the nodes, `busbar project csv --all` the parts"};
    }
    return read.mapping;
}

bool is_same_part(const MappedPart& a, const MappedPart& b)
{
    return a.kind == b.kind && a.number == b.number && a.name == b.name;
}

/// Adds the labels of `from`.
void merge(MappedPart& into, const MappedPart& from)
{
    into.label = from.label.empty() ? into.label : from.label;
    into.is_array = into.is_array || from.is_array;
    into.is_structure = into.is_structure || from.is_structure;
    if (from.specification != controller::ArraySpecification{}) {
        into.specification = from.specification;
    }
    for (const MappedPart& part : from.parts) {
        const auto found =
            std::find_if(into.parts.begin(), into.parts.end(),
                         [&](const MappedPart& each) { return is_same_part(each, part); });
        merge(found != into.parts.end()
                  ? *found
                  : into.parts.emplace_back(
                        MappedPart{.kind = part.kind, .number = part.number, .name = part.name}),
              part);
    }
}

void merge(std::string& into, const std::string& from)
{
    into = from.empty() ? into : from;
}

void merge(std::vector<MappedPart>& arguments, const std::vector<MappedPart>& from)
{
    MappedPart all{.parts = std::move(arguments)};
    merge(all, MappedPart{.parts = from});
    arguments = std::move(all.parts);
    std::sort(arguments.begin(), arguments.end(),
              [](const auto& a, const auto& b) { return a.number < b.number; });
}

void merge(Mapping& into, const Mapping& from)
{
    for (const auto& [node, mapping] : from.variables) {
        controller::DataMapping& variable = into.variables[node];
        merge(variable.value, mapping.value);
        merge(variable.quality, mapping.quality);
        variable.scaling = mapping.scaling.is_set() ? mapping.scaling : variable.scaling;
    }
    for (const auto& [node, mapping] : from.methods) {
        controller::MethodMapping& method = into.methods[node];
        merge(method.handle, mapping.handle);
        merge(method.done, mapping.done);
        merge(method.arguments, mapping.arguments);
        merge(method.outputs, mapping.outputs);
    }
}

/// Takes the labels of a part, and of parts within it, away where `taken` has a label. Returns how
/// many there were.
std::size_t take_away(std::string& label, const std::string& taken)
{
    return !taken.empty() && !std::exchange(label, {}).empty() ? 1 : 0;
}

std::size_t take_away(std::vector<MappedPart>& parts, const std::vector<MappedPart>& taken);

std::size_t take_away(MappedPart& part, const MappedPart& taken)
{
    if (taken.label.empty()) {
        return take_away(part.parts, taken.parts);
    }
    const std::size_t count = controller::count_labels(part);
    part.label.clear();
    part.parts.clear();
    return count;
}

std::size_t take_away(std::vector<MappedPart>& parts, const std::vector<MappedPart>& taken)
{
    std::size_t count = 0;
    for (const MappedPart& each : taken) {
        for (MappedPart& part : parts) {
            count += is_same_part(part, each) ? take_away(part, each) : 0;
        }
    }
    std::erase_if(parts,
                  [](const MappedPart& part) { return part.label.empty() && part.parts.empty(); });
    return count;
}

std::size_t take_away(controller::DataMapping& variable, const controller::DataMapping& taken)
{
    const bool loses_scaling = taken.scaling.is_set() && variable.scaling.is_set();
    variable.scaling = loses_scaling ? controller::Scaling{} : variable.scaling;
    return take_away(variable.value, taken.value) + take_away(variable.quality, taken.quality) +
           (loses_scaling ? 1 : 0);
}

std::size_t take_away(controller::MethodMapping& method, const controller::MethodMapping& taken)
{
    return take_away(method.handle, taken.handle) + take_away(method.done, taken.done) +
           take_away(method.arguments, taken.arguments) + take_away(method.outputs, taken.outputs);
}

template <typename Map>
std::size_t take_away(Map& all, const Map& taken)
{
    std::size_t count = 0;
    for (const auto& [node, part] : taken) {
        const auto found = all.find(node);
        if (found == all.end()) {
            continue;
        }
        count += take_away(found->second, part);
        if (controller::count_labels(found->second) == 0) {
            all.erase(found);
        }
    }
    return count;
}

/// Not where the check finds an error with one of these nodes that was changed.
void keep_mapping(Context& context, const std::string& path, controller::Project& project,
                  const ModelSet& models, const Mapping& changed)
{
    const auto check = controller::check_project_mapping(project, models);
    bool is_wrong = false;
    for (const controller::ModelReport& report : check.reports.list()) {
        const bool is_error =
            controller::rule_of(report.code).result == controller::ReportResult::Error;
        if (is_error &&
            (changed.variables.contains(report.node) || changed.methods.contains(report.node))) {
            context.warn("error", safe(controller::text(report)));
            is_wrong = true;
        }
    }
    if (is_wrong) {
        throw Failure{Exit::Failed, "not mapped", "the project is as it was"};
    }
    controller::keep_models(models, project);
    save_project(path, project);
}

/// The changes of a mapping that a command makes.
struct MappingChange {
    Mapping labels;
    /// A mapping with a label, no matter which, for each part that loses its own.
    Mapping taken;
};

/// Reads LABEL [PART], and more pairs of both, from `words`; "" takes the label of PART away. Parts
/// that only count together, as those of a Method with OutputArguments, are mapped at once.
MappingChange labels_of(Context& context, const ModelSet& models,
                        const std::vector<std::string>& words)
{
    if (words.size() > 4 && words.size() % 2 != 0) {
        throw Failure{Exit::Usage, safe(words.back()) + ": a label without its part",
                      "expected LABEL PART, as often as there are parts"};
    }
    MappingChange change;
    for (std::size_t i = 2; i < words.size(); i += 2) {
        const std::string part = i + 1 < words.size() ? words[i + 1] : "";
        const bool is_taken = words[i].empty();
        const std::string any = part == "Scaling" ? "0..1=0..1" : "label";
        merge(is_taken ? change.taken : change.labels,
              mapping_of(context, models, words[1], "Part,Label",
                         quoted(part) + "," + quoted(is_taken ? any : words[i])));
    }
    return change;
}

/// Takes all labels of a node away.
Exit clear_node(Context& context, const ProjectArguments& arguments)
{
    const auto& words = arguments.words;
    controller::Project project = open_project(words[0]);
    ModelSet models = open_models(project);
    const model::NodeIndex node = controller::find_table_node(words[1], models.space());
    if (node == model::no_node) {
        throw Failure{Exit::Failed, safe(words[1]) + ": there is no such node",
                      "`busbar project tree` lists the nodes"};
    }
    const NodeId id = models.space().node_id(node);
    models.mapping().variables.erase(id);
    models.mapping().methods.erase(id);
    keep_mapping(context, words[0], project, models, {});
    return admin::report(context, safe(words[1]) + ": nothing is mapped");
}

/// A label for a node or, with PART, for a part of it; "" takes the labels of the part away, or all
/// of the node.
Exit map_node(Context& context, const ProjectArguments& arguments)
{
    const auto& words = arguments.words;
    if (words.size() == 3 && words[2].empty()) {
        return clear_node(context, arguments);
    }
    controller::Project project = open_project(words[0]);
    ModelSet models = open_models(project);
    MappingChange change = labels_of(context, models, words);
    Mapping& all = models.mapping();
    const std::size_t taken = take_away(all.variables, change.taken.variables) +
                              take_away(all.methods, change.taken.methods);
    if (taken == 0 && change.labels.variables.empty() && change.labels.methods.empty()) {
        throw Failure{Exit::Failed, safe(words[1]) + ": nothing is mapped there",
                      "`busbar project csv` lists what is mapped"};
    }
    merge(all, change.labels);
    const Mapping changed = std::exchange(change.labels, {});
    merge(change.taken, changed); // both are checked
    keep_mapping(context, words[0], project, models, change.taken);
    if (taken != 0) {
        return admin::report(context, safe(words[1]) + " has " + std::to_string(taken) +
                                          " labels less and " +
                                          std::to_string(count_labels(changed)) + " more");
    }
    return admin::report(context,
                         safe(words[1]) +
                             (words.size() <= 4
                                  ? " is " + safe(words[2])
                                  : " has " + std::to_string(count_labels(changed)) + " labels"));
}

/// Rank and dimensions of an array that does not say them itself (SH-082679, 9.5), with the first
/// labels of it: without any label it is not kept.
Exit specify_array(Context& context, const ProjectArguments& arguments)
{
    const auto& words = arguments.words;
    controller::Project project = open_project(words[0]);
    ModelSet models = open_models(project);
    std::string columns = "Part,Label,Rank";
    std::string fields = quoted(arguments.part) + ",," + quoted(words[2]);
    for (std::size_t i = 3; i < words.size(); ++i) {
        columns += ",Dim" + std::to_string(i - 2);
        fields += "," + quoted(words[i]);
    }
    const Mapping changed = mapping_of(context, models, words[1], columns, fields);
    merge(models.mapping(), changed);
    if (!arguments.label.empty()) {
        std::string place = arguments.part;
        for (char rank = words[2].size() == 1 ? words[2].front() : '0'; rank > '0'; --rank) {
            place += "[0]";
        }
        merge(models.mapping(),
              mapping_of(context, models, words[1], "Part,Label",
                         quoted(std::as_const(place)) + "," + quoted(arguments.label)));
    }
    keep_mapping(context, words[0], project, models, changed);
    return admin::report(context, safe(words[1]) + " has its array specification");
}

/// Counts the labels of a part, and of parts within it, that `other`, which may be null, lacks.
std::size_t count_lost(const MappedPart& part, const MappedPart* other)
{
    std::size_t lost = !part.label.empty() && (other == nullptr || other->label.empty()) ? 1 : 0;
    for (const MappedPart& inner : part.parts) {
        const MappedPart* same = nullptr;
        for (std::size_t i = 0; other != nullptr && i < other->parts.size(); ++i) {
            same = is_same_part(other->parts[i], inner) ? &other->parts[i] : same;
        }
        lost += count_lost(inner, same);
    }
    return lost;
}

MappedPart field_of(const char* name, std::string label, std::vector<MappedPart> parts = {})
{
    return {.kind = MappedPart::Kind::Field,
            .name = name,
            .label = std::move(label),
            .parts = std::move(parts)};
}

/// All labels of a node as parts of one value.
MappedPart part_of(const controller::MethodMapping& method)
{
    return {.label = method.handle,
            .parts = {field_of("Done", method.done), field_of("Input", {}, method.arguments),
                      field_of("Output", {}, method.outputs)}};
}
MappedPart part_of(const controller::DataMapping& variable)
{
    return {.parts = {field_of("Quality", variable.quality),
                      field_of("Scaling", to_text(variable.scaling)),
                      field_of("Value", {}, {variable.value})}};
}

/// Counts the labels of nodes that `kept` lacks.
template <typename Map>
std::size_t count_lost(const Map& mapping, const Map& kept)
{
    std::size_t lost = 0;
    for (const auto& [node, each] : mapping) {
        const auto other = kept.find(node);
        const MappedPart same = other != kept.end() ? part_of(other->second) : MappedPart{};
        lost += count_lost(part_of(each), &same);
    }
    return lost;
}

/// Throws Failure unless the user lets the labels go that `kept` has no line for.
void make_sure_of_loss(Context& context, const ProjectArguments& arguments, const Mapping& mapping,
                       const Mapping& kept)
{
    const std::size_t lost =
        count_lost(mapping.variables, kept.variables) + count_lost(mapping.methods, kept.methods);
    if (lost != 0 && !arguments.is_sure &&
        !confirm(context, "take " + std::to_string(lost) + " labels away?")) {
        throw Failure{Exit::Failed,
                      "the table has no line for " + std::to_string(lost) +
                          " labels of the project: nothing was changed",
                      "--yes takes them away without a question"};
    }
}

/// Writes the table to standard output, or reads it into the project: in addition to the mapping
/// there, or in its place.
Exit table_of(Context& context, const ProjectArguments& arguments)
{
    const std::string& path = arguments.words[0];
    controller::Project project = open_project(path);
    ModelSet models = open_models(project);
    if (arguments.table.empty()) {
        using controller::PartsWritten;
        const bool wants_parts = arguments.wants_all || arguments.wants_unmapped;
        context.out.write(
            wants_parts
                ? controller::write_mappable_table(
                      models, arguments.wants_unmapped ? PartsWritten::Unmapped : PartsWritten::All)
                : controller::write_mapping_table(models.space(), models.mapping()));
        return Exit::Good;
    }
    auto read = controller::read_mapping_table(
        read_file(arguments.table, controller::MappingTableLimits{}.max_size), models.space());
    print_reports(context, read.reports);
    if (read.reports.has_errors()) {
        throw Failure{Exit::Failed, arguments.table + ": not accepted", "the project is as it was"};
    }
    if (arguments.replaces) {
        make_sure_of_loss(context, arguments, models.mapping(), read.mapping);
        models.mapping() = read.mapping;
    } else {
        merge(models.mapping(), read.mapping);
    }
    for (controller::TableRoles& each : read.roles) {
        models.set_roles(models.space().find(each.node), std::move(each.roles));
    }
    keep_mapping(context, path, project, models, read.mapping);
    return admin::report(
        context, std::to_string(controller::count_labels(read.mapping)) + " labels of the table, " +
                     std::to_string(controller::count_labels(models.mapping())) + " in all" +
                     (read.roles.empty()
                          ? std::string{}
                          : ", and the roles of " + std::to_string(read.roles.size()) + " nodes"));
}

} // namespace

void add_mapping(CLI::App& project, Run& run)
{
    const auto arguments = std::make_shared<ProjectArguments>();
    constexpr std::size_t most_words = 512;
    auto* map = add_offline(
        project, run, "map", "Maps a node, or parts of it, to labels; \"\" as LABEL unmaps.", 3,
        most_words, "FILE NODE LABEL [PART] [LABEL PART]...", map_node, arguments);
    map->footer("A LABEL \"\" takes that of PART away, without PART all of the node.\n"
                "PART is .Name, [0] or [0].Name of a structure or an array, Quality or Scaling\n"
                "(0..27648=0..1500) of a Variable, Handle, Done, Input[0] or Output[0] of a\n"
                "Method: `busbar project csv FILE --unmapped` lists them with their types,\n"
                "`busbar project types` the types of labels.");
    auto* array =
        add_offline(project, run, "array", "Sets the dimensions that an array is mapped with.", 3,
                    6, "FILE NODE RANK [DIM]...", specify_array, arguments);
    array->add_option("--part", arguments->part,
                      "the array within the value, if the node itself is not an array");
    array->add_option("--first", arguments->label, "the label of the first element");
    auto* csv =
        add_offline(project, run, "csv", "Prints the mapping as a table, or takes it from one.", 1,
                    1, "FILE", table_of, arguments);
    auto* in = csv->add_option("--in", arguments->table,
                               "adds this table to the mapping; from a spreadsheet, too")
                   ->type_name("TABLE");
    csv->add_flag("--replace", arguments->replaces,
                  "drops the mapping that the table does not have")
        ->needs(in);
    csv->add_flag("--yes", arguments->is_sure, "takes labels away without a question");
    auto* all = csv->add_flag("--all", arguments->wants_all,
                              "prints a line for each part that could have a label, too")
                    ->excludes(in);
    csv->add_flag("--unmapped", arguments->wants_unmapped,
                  "prints the parts that could have a label and have none")
        ->excludes(in)
        ->excludes(all);
    add_offline(project, run, "types", "Lists the types of labels and what can be mapped to them.",
                0, 0, "", list_label_types, arguments);
}

} // namespace busbar::tool::project
