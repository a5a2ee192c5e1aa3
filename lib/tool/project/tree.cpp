#include <algorithm>
#include <set>

#include <busbar/controller/mappable_parts.hpp>
#include <busbar/controller/project_models.hpp>

#include "commands.hpp"
#include "node_text.hpp"
#include "tool/nodes/names.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

using controller::MappablePart;
using controller::ModelSet;

/// A row of the tree (SH-082679, 9.4). What a part or an argument does not have stays empty.
struct TreeRow {
    std::string name{};
    std::string display_name{};
    std::string node_class{};
    std::string data_type{};
    std::string type_definition{};
    std::string value_rank{};
    std::string array_dimensions{};
    std::string access{};
    std::string description{};
    std::string node_id{};
    std::string mapping{};
};

/// In the order of the columns. Only some are shown where not all are wanted.
struct TreeColumn {
    Column column;
    std::string TreeRow::*text;
    bool is_always_shown;
};
const std::array tree_columns{
    TreeColumn{{"NODE", 24}, &TreeRow::name, true},
    TreeColumn{{"DISPLAYNAME", 12}, &TreeRow::display_name, false},
    TreeColumn{{"CLASS"}, &TreeRow::node_class, true},
    TreeColumn{{"DATATYPE", 10}, &TreeRow::data_type, true},
    TreeColumn{{"NODEID", 12}, &TreeRow::node_id, true},
    TreeColumn{{"ACCESS", 2}, &TreeRow::access, true},
    TreeColumn{{"TYPE", 10}, &TreeRow::type_definition, true},
    TreeColumn{{"VALUERANK", 4}, &TreeRow::value_rank, false},
    TreeColumn{{"ARRAYDIMENSIONS", 4}, &TreeRow::array_dimensions, false},
    TreeColumn{{"MAPPING", 12}, &TreeRow::mapping, true},
    TreeColumn{{"DESCRIPTION", 12}, &TreeRow::description, false},
};

/// The nodes of the models below Objects, each where it is found first.
class TreeLister {
public:
    TreeLister(const ModelSet& models, bool has_parts, bool has_all)
        : models_{models}, space_{models.space()}, parts_{models},
          has_parts_{has_parts || has_all}, has_all_{has_all}, table_{shown_columns(has_all)}
    {
    }

    void list(model::NodeIndex node, std::size_t level);
    void print(Context& context) { print_rows(context, json_.close_array(), table_); }

private:
    static constexpr std::size_t max_levels = 100;

    [[nodiscard]] static std::vector<Column> shown_columns(bool has_all)
    {
        std::vector<Column> shown;
        for (const TreeColumn& each : tree_columns) {
            if (has_all || each.is_always_shown) {
                shown.push_back(each.column);
            }
        }
        return shown;
    }
    void add_row(const TreeRow& row, std::size_t level);
    void add(model::NodeIndex node, std::size_t level);
    void add_parts(const std::vector<MappablePart>& parts, std::string_view place,
                   std::size_t level);
    void add_arguments(model::NodeIndex node, const std::vector<MappablePart>& parts,
                       std::size_t level);
    void write_json(model::NodeIndex node, const TreeRow& row, std::size_t level);
    [[nodiscard]] TreeRow row_of(model::NodeIndex node) const;
    [[nodiscard]] std::string mapping_of(const NodeId& id) const;

    const ModelSet& models_;
    const model::SpaceReader& space_;
    controller::MappableParts parts_;
    bool has_parts_;
    bool has_all_;
    std::set<model::NodeIndex> seen_;
    JsonLine json_{std::move(JsonLine{}.open_array())};
    Table table_;
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

/// "Int16[3]", as the tool of SH-082679 shows it (9.5).
std::string type_with_dimensions(const std::string& type, std::int32_t rank,
                                 std::span<const std::uint32_t> dimensions)
{
    if (rank < 0 && rank != -1) {
        return type + "[-]";
    }
    std::string text = type;
    for (std::int32_t i = 0; i < rank; ++i) {
        const auto dimension = static_cast<std::size_t>(i);
        const bool is_known = dimension < dimensions.size();
        text += "[" + (is_known ? std::to_string(dimensions[dimension]) : "") + "]";
    }
    return text;
}

TreeRow TreeLister::row_of(model::NodeIndex node) const
{
    TreeRow row;
    const NodeId id = space_.node_id(node);
    row.name = to_string(space_.browse_name(node));
    row.display_name = space_.display_name(node).text.view();
    row.node_class = name(space_.node_class(node));
    if (space_.node_class(node) == NodeClass::Variable) {
        const model::VariableAttributes variable = space_.variable(node);
        row.data_type = type_with_dimensions(plain_name(space_, space_.data_type_id(node)),
                                             variable.value_rank, variable.array_dimensions);
        row.value_rank = rank_text(variable.value_rank);
        row.array_dimensions = dimensions_text(variable.array_dimensions);
        const auto level = static_cast<unsigned>(variable.access_level);
        row.access = std::string{(level & 1U) != 0 ? "r" : "-"} + ((level & 2U) != 0 ? "w" : "-");
    }
    if (const auto type = space_.type_definition(node); type != model::no_node) {
        row.type_definition = space_.browse_name(type).name.view();
    }
    const auto descriptions = space_.texts(node, AttributeId::Description);
    row.description = descriptions.empty() ? "" : descriptions.front().text.view();
    row.node_id = to_string(id);
    row.mapping = mapping_of(id);
    return row;
}

void TreeLister::add_row(const TreeRow& row, std::size_t level)
{
    std::vector<Cell> cells;
    for (const TreeColumn& each : tree_columns) {
        if (has_all_ || each.is_always_shown) {
            const std::string indent(cells.empty() ? 2 * level : 0, ' ');
            cells.push_back({indent + safe(row.*each.text)});
        }
    }
    table_.add(std::move(cells));
}

void TreeLister::write_json(model::NodeIndex node, const TreeRow& row, std::size_t level)
{
    json_.open_object().member("level", static_cast<std::int64_t>(level));
    json_.member("name", row.name).member("nodeId", row.node_id);
    json_.member("nodeClass", row.node_class).member("dataType", row.data_type);
    json_.member("mapping", row.mapping).member("displayName", row.display_name);
    json_.member("description", row.description).member("typeDefinition", row.type_definition);
    if (space_.node_class(node) == NodeClass::Variable) {
        const model::VariableAttributes variable = space_.variable(node);
        json_.member("valueRank", static_cast<std::int64_t>(variable.value_rank));
        json_.member("arrayDimensions", row.array_dimensions);
        json_.member("accessLevel", static_cast<std::int64_t>(variable.access_level));
    }
    json_.close_object();
}

void TreeLister::add(model::NodeIndex node, std::size_t level)
{
    const TreeRow row = row_of(node);
    write_json(node, row, level);
    add_row(row, level);
    if (!has_parts_) {
        return;
    }
    const std::vector<MappablePart> parts = parts_.of(node);
    if (has_all_ && space_.node_class(node) == NodeClass::Method) {
        add_parts(parts, "Handle", level + 1);
        return add_arguments(node, parts, level + 1);
    }
    add_parts(parts, {}, level + 1);
}

/// Fields, elements, the Handle and arguments, unless the node itself is all that can be mapped;
/// those whose path begins with `place`.
void TreeLister::add_parts(const std::vector<MappablePart>& parts, std::string_view place,
                           std::size_t level)
{
    for (const MappablePart& part : parts) {
        if (part.path.empty() || !part.path.starts_with(place)) {
            continue;
        }
        json_.open_object().member("level", static_cast<std::int64_t>(level));
        json_.member("part", part.path).member("dataType", part.type);
        json_.member("mapping", part.label).close_object();
        add_row({.name = part.path, .data_type = part.type, .mapping = part.label}, level);
    }
}

/// Each with the parts of it that can be mapped below it, of InputArguments.
void TreeLister::add_arguments(model::NodeIndex node, const std::vector<MappablePart>& parts,
                               std::size_t level)
{
    for (const NamedArgument& each : arguments_of(space_, node)) {
        const Argument& argument = each.argument;
        TreeRow row;
        row.name = each.place + " " + std::string{argument.name.view()};
        row.data_type = type_with_dimensions(plain_name(space_, argument.data_type),
                                             argument.value_rank, argument.array_dimensions.span());
        row.value_rank = rank_text(argument.value_rank);
        row.array_dimensions = dimensions_text(argument.array_dimensions.span());
        row.description = argument.description.text.view();
        const auto whole = std::find_if(parts.begin(), parts.end(), [&](const MappablePart& part) {
            return part.path == each.place;
        });
        row.mapping = whole != parts.end() ? whole->label : "";
        json_.open_object().member("level", static_cast<std::int64_t>(level));
        json_.member("argument", each.place).member("name", argument.name.view());
        json_.member("dataType", row.data_type).member("description", row.description);
        json_.member("mapping", row.mapping).close_object();
        add_row(row, level);
        if (whole == parts.end()) {
            add_parts(parts, each.place, level + 1);
        }
    }
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

} // namespace

Exit show_tree(Context& context, const ProjectArguments& arguments)
{
    const ModelSet models = open_models(open_project(arguments.words[0]));
    TreeLister tree{models, arguments.has_parts, arguments.wants_all};
    tree.list(models.space().find(id::ObjectsFolder), 0);
    tree.print(context);
    return Exit::Good;
}

} // namespace busbar::tool::project
