#include <algorithm>
#include <map>
#include <optional>
#include <unordered_set>

#include <busbar/controller/mapping_table.hpp>
#include <busbar/controller/node_roles.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/model/relative_path.hpp>
#include <busbar/types/ids.hpp>

#include "core/ascii_case.hpp"
#include "core/number_text.hpp"
#include "core/utf8.hpp"
#include "part_text.hpp"
#include "table_fields.hpp"

namespace busbar::controller {

namespace {

using detail::PartTree;
using detail::TableColumn;
using detail::TableFields;
using model::NodeIndex;

NodeIndex find_id(std::string_view text, const model::SpaceReader& space)
{
    const auto id = parse_expanded_node_id(text);
    if (!id || id->server_index != 0) {
        return model::no_node;
    }
    NodeId plain = id->node_id;
    if (!id->namespace_uri.empty()) {
        const auto index = space.namespace_index(id->namespace_uri.view());
        if (!index) {
            return model::no_node;
        }
        plain.set_namespace_index(*index);
    }
    return space.find(plain);
}

NodeIndex find_path(std::string_view text, const model::SpaceReader& space)
{
    const auto path = model::parse_relative_path(text, space);
    if (!path || path->elements.empty()) {
        return model::no_node;
    }
    NodeIndex at = space.find(id::RootFolder);
    for (const RelativePathElement& element : path->elements) {
        NodeIndex next = model::no_node;
        const NodeIndex type = space.find(element.reference_type_id);
        if (type == model::no_node || element.is_inverse) {
            return model::no_node;
        }
        space.for_each_child(at, type, element.include_subtypes, element.target_name,
                             [&](NodeIndex child) {
                                 next = child;
                                 return false;
                             });
        if (next == model::no_node) {
            return next;
        }
        at = next;
    }
    return at;
}

/// A Variable while its lines are read.
struct VariableTree {
    PartTree value;
    std::string quality;
    Scaling scaling;
};

/// A Method while its lines are read.
struct MethodTree {
    std::string handle;
    std::string done;
    /// Indexed by the number of the argument.
    std::map<std::uint32_t, PartTree> inputs;
    std::map<std::uint32_t, PartTree> outputs;
};

std::vector<MappedPart> take_arguments(std::map<std::uint32_t, PartTree>& trees)
{
    std::vector<MappedPart> arguments;
    for (auto& [number, argument] : trees) {
        arguments.push_back(argument.take());
        arguments.back().number = number;
    }
    return arguments;
}

class TableReader {
public:
    TableReader(std::string_view text, const model::SpaceReader& space,
                const MappingTableLimits& limits)
        : space_{space}, limits_{limits}, table_{text, limits.max_field}
    {
    }

    [[nodiscard]] ReadMappingTable take()
    {
        if (read_header()) {
            read_lines();
        }
        for (auto& [id, tree] : variables_) {
            result_.mapping.variables[id] = {.value = tree.value.take(),
                                             .quality = std::move(tree.quality),
                                             .scaling = tree.scaling};
        }
        for (auto& [id, tree] : methods_) {
            MethodMapping& mapping = result_.mapping.methods[id];
            mapping.handle = std::move(tree.handle);
            mapping.done = std::move(tree.done);
            mapping.arguments = take_arguments(tree.inputs);
            mapping.outputs = take_arguments(tree.outputs);
        }
        return std::move(result_);
    }

private:
    [[nodiscard]] bool read_header();
    void read_lines();
    void read_line();
    [[nodiscard]] NodeIndex find_node() const;
    [[nodiscard]] bool read_specification(ArraySpecification& to);
    void read_variable(const NodeId& id, const MappedPart& line);
    void read_method(const NodeId& id, const MappedPart& line);
    void read_argument(std::map<std::uint32_t, PartTree>& trees, std::string_view path,
                       std::string_view rest, const MappedPart& line);
    void read_label(std::string& to, std::string_view path, const MappedPart& line);
    void read_scaling(Scaling& to, const MappedPart& line);
    void read_roles(const NodeId& id, const MappedPart& line);
    void read_part(PartTree& tree, std::string_view path, const MappedPart& line);

    [[nodiscard]] const std::string& field(TableColumn column) const
    {
        static const std::string none;
        const auto position = positions_[static_cast<std::size_t>(column)];
        return position && *position < fields_.size() ? fields_[*position] : none;
    }
    [[nodiscard]] bool has(TableColumn column) const
    {
        return positions_[static_cast<std::size_t>(column)].has_value();
    }
    void report(ModelCode code, std::string_view found)
    {
        result_.reports.add({code, {}, "line " + std::to_string(table_.line()), printable(found)});
    }

    const model::SpaceReader& space_;
    const MappingTableLimits& limits_;
    TableFields table_;
    std::vector<std::string> fields_;
    std::array<std::optional<std::size_t>, detail::table_columns.size()> positions_;
    std::unordered_map<NodeId, VariableTree> variables_;
    std::unordered_map<NodeId, MethodTree> methods_;
    std::unordered_set<NodeId> with_roles_;
    ReadMappingTable result_;
};

bool TableReader::read_header()
{
    if (table_.next(fields_) != TableFields::Line::Read) {
        report(ModelCode::TableInvalid, {});
        return false;
    }
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        const auto* const known = std::find_if(
            detail::table_columns.begin(), detail::table_columns.end(), [&](std::string_view name) {
                return busbar::detail::is_same_ignoring_case(name, fields_[i]);
            });
        if (known == detail::table_columns.end()) {
            continue;
        }
        auto& position =
            positions_[static_cast<std::size_t>(known - detail::table_columns.begin())];
        if (position) {
            report(ModelCode::TableHeader, *known);
            return false;
        }
        position = i;
    }
    if ((!has(TableColumn::NodeId) && !has(TableColumn::Path)) || !has(TableColumn::Part) ||
        !has(TableColumn::Label)) {
        report(ModelCode::TableHeader, {});
        return false;
    }
    return true;
}

void TableReader::read_lines()
{
    for (std::size_t count = 0;; ++count) {
        switch (table_.next(fields_)) {
        case TableFields::Line::Read:
            break;
        case TableFields::Line::End:
            return;
        case TableFields::Line::Broken:
            report(ModelCode::TableInvalid, "unbalanced quotation marks");
            return;
        case TableFields::Line::TooLarge:
            report(ModelCode::TableTooLarge, {});
            return;
        }
        if (count == limits_.max_lines) {
            report(ModelCode::TableTooLarge,
                   "more than " + std::to_string(limits_.max_lines) + " lines");
            return;
        }
        read_line();
    }
}

void TableReader::read_line()
{
    MappedPart line;
    line.label = field(TableColumn::Label);
    if (!read_specification(line.specification)) {
        return;
    }
    if (line.label.empty() && line.specification.rank == ArraySpecification::none) {
        return;
    }
    const NodeIndex node = find_node();
    if (node == model::no_node) {
        report(ModelCode::TableNode,
               field(field(TableColumn::NodeId).empty() ? TableColumn::Path : TableColumn::NodeId));
        return;
    }
    const NodeClass node_class = space_.node_class(node);
    if (field(TableColumn::Part) == detail::roles_part) {
        read_roles(space_.node_id(node), line);
    } else if (node_class == NodeClass::Variable) {
        read_variable(space_.node_id(node), line);
    } else if (node_class == NodeClass::Method) {
        read_method(space_.node_id(node), line);
    } else {
        report(ModelCode::TableNode, "it is neither a Variable nor a Method");
    }
}

bool TableReader::read_specification(ArraySpecification& to)
{
    const auto read = [&](TableColumn column, std::int64_t low, std::int64_t high, auto& number) {
        const std::string& text = field(column);
        if (text.empty()) {
            return true;
        }
        std::int64_t value = 0;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = busbar::detail::read_number(text.data(), end, value);
        if (error != std::errc{} || stop != end || value < low || value > high) {
            report(ModelCode::TableNumber, text);
            return false;
        }
        number = static_cast<std::decay_t<decltype(number)>>(value);
        return true;
    };
    const std::int64_t most = limits_.max_elements;
    if (!read(TableColumn::Rank, -1, 3, to.rank) ||
        !read(TableColumn::Dim1, 1, most, to.dimensions[0]) ||
        !read(TableColumn::Dim2, 1, most, to.dimensions[1]) ||
        !read(TableColumn::Dim3, 1, most, to.dimensions[2])) {
        return false;
    }
    if (to.rank == ArraySpecification::none) {
        to = {};
    }
    return true;
}

NodeIndex TableReader::find_node() const
{
    const std::string& id = field(TableColumn::NodeId);
    return id.empty() ? find_path(field(TableColumn::Path), space_) : find_id(id, space_);
}

void TableReader::read_variable(const NodeId& id, const MappedPart& line)
{
    VariableTree& variable = variables_[id];
    const std::string_view path = field(TableColumn::Part);
    if (path == detail::quality_part) {
        read_label(variable.quality, path, line);
    } else if (path == detail::scaling_part) {
        read_scaling(variable.scaling, line);
    } else {
        read_part(variable.value, path, line);
    }
}

/// Sets the label of something that has no parts.
void TableReader::read_label(std::string& to, std::string_view path, const MappedPart& line)
{
    if (!to.empty()) {
        report(ModelCode::TableRepeated, path);
        return;
    }
    to = line.label;
}

void TableReader::read_scaling(Scaling& to, const MappedPart& line)
{
    if (to.is_set()) {
        report(ModelCode::TableRepeated, detail::scaling_part);
        return;
    }
    const auto scaling = parse_scaling(line.label);
    if (!scaling) {
        report(ModelCode::TableScaling, "found " + line.label);
        return;
    }
    to = *scaling;
}

void TableReader::read_roles(const NodeId& id, const MappedPart& line)
{
    if (id.namespace_index() == 0) {
        report(ModelCode::TableRoles, "a node of namespace 0, which no model has");
        return;
    }
    if (!with_roles_.insert(id).second) {
        report(ModelCode::TableRepeated, detail::roles_part);
        return;
    }
    auto roles = parse_roles(line.label);
    if (!roles) {
        report(ModelCode::TableRoles, text(roles.error()));
        return;
    }
    result_.roles.push_back({id, *std::move(roles)});
}

void TableReader::read_method(const NodeId& id, const MappedPart& line)
{
    const std::string_view path = field(TableColumn::Part);
    MethodTree& method = methods_[id];
    const auto is_below = [&](std::string_view place) {
        return path.starts_with(place) && path.size() > place.size();
    };
    if (path == detail::handle_part) {
        read_label(method.handle, path, line);
    } else if (path == detail::done_part) {
        read_label(method.done, path, line);
    } else if (is_below(detail::input_part)) {
        read_argument(method.inputs, path, path.substr(detail::input_part.size()), line);
    } else if (is_below(detail::output_part)) {
        read_argument(method.outputs, path, path.substr(detail::output_part.size()), line);
    } else {
        report(ModelCode::TablePart, path);
    }
}

void TableReader::read_argument(std::map<std::uint32_t, PartTree>& trees, std::string_view path,
                                std::string_view rest, const MappedPart& line)
{
    const auto steps = detail::read_part_path(rest, limits_.max_part_levels, limits_.max_elements);
    if (!steps || steps->front().kind != MappedPart::Kind::Element) {
        report(ModelCode::TablePart, path);
        return;
    }
    // The argument's number comes first.
    read_part(trees[steps->front().number], rest.substr(rest.find(']') + 1), line);
}

void TableReader::read_part(PartTree& tree, std::string_view path, const MappedPart& line)
{
    const auto steps = detail::read_part_path(path, limits_.max_part_levels, limits_.max_elements);
    MappedPart* const part = steps ? tree.at(*steps) : nullptr;
    if (part == nullptr) {
        report(ModelCode::TablePart, path);
        return;
    }
    const bool has_rank = line.specification.rank != ArraySpecification::none;
    if ((!line.label.empty() && !part->label.empty()) ||
        (has_rank && part->specification.rank != ArraySpecification::none)) {
        report(ModelCode::TableRepeated, path);
        return;
    }
    part->label = line.label.empty() ? part->label : line.label;
    if (has_rank) {
        part->specification = line.specification;
        part->is_array = part->is_array || line.specification.rank > 0;
    }
}

} // namespace

ReadMappingTable read_mapping_table(std::string_view text, const model::SpaceReader& space,
                                    const MappingTableLimits& limits)
{
    ReadMappingTable result;
    if (text.size() > limits.max_size) {
        result.reports.add({ModelCode::TableTooLarge,
                            {},
                            {},
                            "more than " + std::to_string(limits.max_size) + " bytes"});
        return result;
    }
    const auto decoded = decode_text(text, "table", limits.max_size);
    if (!decoded) {
        result.reports.add(
            {ModelCode::TableInvalid, {}, decoded.error().where, decoded.error().text});
        return result;
    }
    result = TableReader{decoded->text(), space, limits}.take();
    result.encoding = decoded->encoding();
    return result;
}

NodeIndex find_table_node(std::string_view text, const model::SpaceReader& space)
{
    return text.starts_with('/') ? find_path(text, space) : find_id(text, space);
}

} // namespace busbar::controller
