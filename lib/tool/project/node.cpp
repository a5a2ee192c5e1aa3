#include <array>
#include <memory>
#include <optional>
#include <span>

#include <busbar/binary/codec.hpp>
#include <busbar/controller/label_check.hpp>
#include <busbar/controller/mapping_table.hpp>
#include <busbar/controller/node_roles.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "commands.hpp"
#include "node_text.hpp"
#include "tool/nodes/names.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"
#include "tool/printing/value.hpp"
#include "tool/printing/value_lines.hpp"

namespace busbar::tool::project {

namespace {

using controller::MappablePart;
using controller::ModelSet;
using model::NodeIndex;

constexpr std::array base_attributes{AttributeId::NodeId,        AttributeId::NodeClass,
                                     AttributeId::BrowseName,    AttributeId::DisplayName,
                                     AttributeId::Description,   AttributeId::WriteMask,
                                     AttributeId::UserWriteMask, AttributeId::RolePermissions};
/// Attributes of some NodeClasses only.
constexpr std::array class_attributes{AttributeId::EventNotifier,
                                      AttributeId::DataType,
                                      AttributeId::ValueRank,
                                      AttributeId::ArrayDimensions,
                                      AttributeId::AccessLevel,
                                      AttributeId::UserAccessLevel,
                                      AttributeId::MinimumSamplingInterval,
                                      AttributeId::Historizing,
                                      AttributeId::Executable,
                                      AttributeId::UserExecutable,
                                      AttributeId::IsAbstract,
                                      AttributeId::Symmetric,
                                      AttributeId::InverseName,
                                      AttributeId::ContainsNoLoops};

/// A table with a title above it, and the same as a member of an object.
class Section {
public:
    Section(std::string title, std::vector<Column> columns, std::vector<const char*> names)
        : title_{std::move(title)}, names_{std::move(names)}, table_{std::move(columns)}
    {
        json_.open_array();
    }

    /// A text for each column.
    void add(const std::vector<std::string>& texts)
    {
        std::vector<Cell> cells;
        json_.open_object();
        for (std::size_t i = 0; i < texts.size(); ++i) {
            json_.member(names_[i], texts[i]);
            cells.push_back({safe(texts[i])});
        }
        json_.close_object();
        table_.add(std::move(cells));
    }
    void print(Output& out) const
    {
        if (table_.row_count() > 0) {
            out.line("");
            out.line(out.styled(Style::Bold, title_));
            table_.print(out);
        }
    }
    void write(JsonLine& json, std::string_view name) const
    {
        JsonLine closed = json_;
        json.key(name).raw(closed.close_array().document());
    }

private:
    std::string title_;
    std::vector<const char*> names_;
    Table table_;
    JsonLine json_;
};

/// All that the tool of SH-082679 shows of a node, in the tabs of its subwindow and in the tree.
class NodePage {
public:
    NodePage(const ModelSet& models, NodeIndex node)
        : space_{models.space()}, node_{node}, types_{std::make_shared<const binary::DynamicTypes>(
                                                   binary::DynamicTypes::compile(
                                                       model::collect_data_types(models.space())))},
          parts_{models}
    {
        add_fields();
        add_values();
        add_arguments();
        add_parts();
        add_references();
    }

    void print(Output& out) const;
    [[nodiscard]] std::string document() const;

private:
    using AttributeIds = std::span<const AttributeId>;

    [[nodiscard]] std::optional<std::string> attribute_text(AttributeId id) const;
    [[nodiscard]] bool has_value() const;
    [[nodiscard]] NodeIndex data_type() const;
    [[nodiscard]] std::string modelling_rule(NodeIndex node) const;
    void print_attributes(Output& out, const char* title, AttributeIds ids) const;
    void write_attributes(JsonLine& json, AttributeIds ids) const;
    void add_fields();
    void add_values();
    void add_arguments();
    void add_parts();
    void add_references();

    const model::SpaceReader& space_;
    NodeIndex node_;
    Types types_;
    controller::MappableParts parts_;
    Section fields_{"Structure Fields",
                    {{"NAME"},
                     {"DATATYPE"},
                     {"VALUERANK"},
                     {"ARRAYDIMENSIONS"},
                     {"MAXSTRINGLENGTH"},
                     {"ISOPTIONAL"},
                     {"DESCRIPTION"}},
                    {"name", "dataType", "valueRank", "arrayDimensions", "maxStringLength",
                     "isOptional", "description"}};
    Section values_{"Enumeration Values", {{"ENUMSTRING"}, {"VALUE"}}, {"enumString", "value"}};
    Section arguments_{
        "Arguments",
        {{"ARGUMENT"}, {"NAME"}, {"DATATYPE"}, {"VALUERANK"}, {"ARRAYDIMENSIONS"}, {"DESCRIPTION"}},
        {"argument", "name", "dataType", "valueRank", "arrayDimensions", "description"}};
    Section mapping_{"Mapping",
                     {{"PART"}, {"TYPE"}, {"LABEL", 12}, {"DECLARED AS", 16}, {"IF IN RANGE", 16}},
                     {"part", "type", "label", "declaredAs", "declaredAsIfInRange"}};
    Section references_{"References",
                        {{"REFERENCETYPE", 12},
                         {"NODECLASS"},
                         {"NAME", 12},
                         {"DATATYPE"},
                         {"TYPEDEFINITION"},
                         {"MODELLINGRULE"},
                         {"NODEID", 12}},
                        {"referenceType", "nodeClass", "name", "dataType", "typeDefinition",
                         "modellingRule", "nodeId"}};
    std::string why_not_mapped_;
};

/// Returns nothing if the NodeClass does not have the attribute; empty if it is not set.
std::optional<std::string> NodePage::attribute_text(AttributeId id) const
{
    if (!model::SpaceReader::has_attribute(space_.node_class(node_), id)) {
        return std::nullopt;
    }
    switch (id) {
    case AttributeId::NodeClass:
        return std::string{name(space_.node_class(node_))};
    case AttributeId::DataType:
        return plain_name(space_, space_.data_type_id(node_));
    case AttributeId::ValueRank:
        return rank_text(space_.variable(node_).value_rank);
    case AttributeId::ArrayDimensions:
        return dimensions_text(space_.variable(node_).array_dimensions);
    case AttributeId::RolePermissions: {
        const model::NodeAccess* const access = space_.node_access(node_);
        return access != nullptr && !access->role_permissions.is_null()
                   ? controller::roles_text(access->role_permissions.span())
                   : std::string{};
    }
    default:
        break;
    }
    const auto value = space_.attribute(node_, id);
    if (!value) {
        return std::string{};
    }
    if (const auto* const text = value->get_if<LocalizedText>()) {
        return std::string{text->text.view()}; // without the locale (9.4)
    }
    const auto* const browse_name = value->get_if<QualifiedName>();
    return browse_name != nullptr ? to_string(*browse_name)
                                  : text_of(*value, types_, {tool::type_of(id)});
}

bool NodePage::has_value() const
{
    return model::SpaceReader::has_attribute(space_.node_class(node_), AttributeId::Value);
}

/// Returns the DataType itself, or that of the values.
NodeIndex NodePage::data_type() const
{
    return space_.node_class(node_) == NodeClass::DataType ? node_
           : has_value()                                   ? space_.variable(node_).data_type
                                                           : model::no_node;
}

void NodePage::add_fields()
{
    const NodeIndex type = data_type();
    const auto definition = type != model::no_node
                                ? space_.attribute(type, AttributeId::DataTypeDefinition)
                                : Result<Variant>{fail(status::Bad_NotFound)};
    const auto structure =
        definition ? binary::structure_of<StructureDefinition>(*definition) : std::nullopt;
    if (!structure) {
        return;
    }
    for (const StructureField& field : structure->fields) {
        fields_.add({std::string{field.name.view()}, plain_name(space_, field.data_type),
                     rank_text(field.value_rank), dimensions_text(field.array_dimensions.span()),
                     std::to_string(field.max_string_length), field.is_optional ? "true" : "false",
                     std::string{field.description.text.view()}});
    }
}

void NodePage::add_values()
{
    const NodeIndex type = data_type();
    if (type == model::no_node || !space_.is_subtype_of(type, id::Enumeration)) {
        return;
    }
    const auto definition = space_.attribute(type, AttributeId::DataTypeDefinition);
    if (const auto fields =
            definition ? binary::structure_of<EnumDefinition>(*definition) : std::nullopt) {
        for (const EnumField& field : fields->fields) {
            values_.add({std::string{field.name.view()}, std::to_string(field.value)});
        }
        return;
    }
    const Variant strings = property_of(space_, type, "EnumStrings");
    if (const auto* const texts = strings.array_if<LocalizedText>()) {
        for (std::size_t i = 0; i < texts->size(); ++i) {
            values_.add({std::string{(*texts)[i].text.view()}, std::to_string(i)});
        }
        return;
    }
    const Variant numbered = property_of(space_, type, "EnumValues");
    const auto* const objects = numbered.array_if<ExtensionObject>();
    for (std::size_t i = 0; objects != nullptr && i < objects->size(); ++i) {
        if (const auto value = binary::structure_of<EnumValueType>((*objects)[i])) {
            values_.add(
                {std::string{value->display_name.text.view()}, std::to_string(value->value)});
        }
    }
}

void NodePage::add_arguments()
{
    for (const NamedArgument& each : arguments_of(space_, node_)) {
        const Argument& argument = each.argument;
        arguments_.add({each.place, std::string{argument.name.view()},
                        plain_name(space_, argument.data_type), rank_text(argument.value_rank),
                        dimensions_text(argument.array_dimensions.span()),
                        std::string{argument.description.text.view()}});
    }
}

void NodePage::add_parts()
{
    for (const MappablePart& part : parts_.of(node_)) {
        const controller::LabelTypes types = controller::label_types_for(part);
        mapping_.add({part.path, part.type, part.label, types.same, types.checked});
    }
    why_not_mapped_ = parts_.why_none(node_);
}

std::string NodePage::modelling_rule(NodeIndex node) const
{
    auto cursor = space_.references(node);
    while (const auto reference = cursor.next()) {
        if (reference->is_forward && space_.is_subtype_of(reference->type, id::HasModellingRule)) {
            return std::string{space_.browse_name(reference->target).name.view()};
        }
    }
    return {};
}

void NodePage::add_references()
{
    auto cursor = space_.references(node_);
    while (const auto reference = cursor.next()) {
        const NodeIndex other = reference->target;
        const NodeClass node_class = space_.node_class(other);
        const bool is_variable =
            node_class == NodeClass::Variable || node_class == NodeClass::VariableType;
        const NodeIndex definition = space_.type_definition(other);
        const std::string type = to_string(space_.browse_name(reference->type));
        references_.add(
            {(reference->is_forward ? "" : "<- ") + type, std::string{name(node_class)},
             to_string(space_.browse_name(other)),
             is_variable ? plain_name(space_, space_.data_type_id(other)) : "",
             definition != model::no_node ? to_string(space_.browse_name(definition)) : "",
             modelling_rule(other), to_string(space_.node_id(other))});
    }
}

void NodePage::print_attributes(Output& out, const char* title, AttributeIds ids) const
{
    Table table{{{title, 24}, {"VALUE", 16}}};
    for (const AttributeId id : ids) {
        if (const auto text = attribute_text(id)) {
            table.add({{std::string{name(id)}}, {safe(*text)}});
        }
    }
    if (has_value() && ids.front() != AttributeId::NodeId) {
        const NodeIndex type = data_type();
        const ValueText value =
            lines_of(space_.value(node_), types_, ValueLimits{}, out.columns(),
                     type == model::no_node ? NodeId{} : NodeId{space_.node_id(type)});
        table.add({{"Value"}, {value.text}}, value.lines);
    }
    if (table.row_count() > 0) {
        table.print(out);
    }
}

void NodePage::print(Output& out) const
{
    print_attributes(out, "BASE ATTRIBUTE", base_attributes);
    out.line("");
    print_attributes(out, "NODECLASS ATTRIBUTE", class_attributes);
    fields_.print(out);
    values_.print(out);
    arguments_.print(out);
    mapping_.print(out);
    if (!why_not_mapped_.empty()) {
        out.line("");
        out.line("cannot be mapped: " + safe(why_not_mapped_));
    }
    references_.print(out);
}

void NodePage::write_attributes(JsonLine& json, AttributeIds ids) const
{
    json.open_object();
    for (const AttributeId id : ids) {
        if (const auto text = attribute_text(id)) {
            json.member(name(id), *text);
        }
    }
}

std::string NodePage::document() const
{
    JsonLine json;
    json.open_object().key("baseAttributes");
    write_attributes(json, base_attributes);
    json.close_object().key("nodeClassAttributes");
    write_attributes(json, class_attributes);
    if (has_value()) {
        json.key("Value");
        append_json(json, space_.value(node_), types_);
    }
    json.close_object();
    fields_.write(json, "structureFields");
    values_.write(json, "enumerationValues");
    arguments_.write(json, "arguments");
    mapping_.write(json, "mapping");
    json.member("whyNotMapped", why_not_mapped_);
    references_.write(json, "references");
    return json.close_object().document();
}

} // namespace

Exit show_node(Context& context, const controller::Project& project, const std::string& text)
{
    const ModelSet models = open_models(project);
    const NodeIndex node = controller::find_table_node(text, models.space());
    if (node == model::no_node) {
        throw Failure{Exit::Failed, safe(text) + ": there is no such node",
                      "`busbar project tree` lists the nodes; a path begins at the Root, as "
                      "/Objects/1:Press"};
    }
    const NodePage page{models, node};
    if (context.options.is_json) {
        context.out.line(page.document());
    } else {
        page.print(context.out);
    }
    return Exit::Good;
}

} // namespace busbar::tool::project
