#include "node_writer.hpp"

#include <charconv>

#include <busbar/types/ids.hpp>

#include "data_types.hpp"

namespace busbar::nodeset {

namespace {

const char* element_of(busbar::NodeClass node_class)
{
    using busbar::NodeClass;
    switch (node_class) {
    case NodeClass::Object:
        return "UAObject";
    case NodeClass::Variable:
        return "UAVariable";
    case NodeClass::Method:
        return "UAMethod";
    case NodeClass::ObjectType:
        return "UAObjectType";
    case NodeClass::VariableType:
        return "UAVariableType";
    case NodeClass::ReferenceType:
        return "UAReferenceType";
    case NodeClass::DataType:
        return "UADataType";
    default:
        return "UAView";
    }
}

std::string dimensions_text(std::span<const std::uint32_t> dimensions)
{
    std::string text;
    for (const std::uint32_t dimension : dimensions) {
        text += (text.empty() ? "" : ",") + std::to_string(dimension);
    }
    return text;
}

} // namespace

void NodeWriter::node(model::NodeIndex index)
{
    static const model::NodeSetNodeExtras none;
    const auto found = extras_.nodes.find(space_.node_id(index));
    const model::NodeSetNodeExtras& extras = found == extras_.nodes.end() ? none : found->second;
    out_.begin(element_of(space_.node_class(index)));
    attributes(index, extras);
    names(index);
    references(index);
    permissions(out_, permissions_of(index));
    if (space_.node_class(index) == busbar::NodeClass::DataType) {
        definition(index, extras);
    }
    value(index);
    if (!extras.elements.empty()) {
        out_.xml(extras.elements);
    }
    out_.end();
}

void NodeWriter::attributes(model::NodeIndex index, const model::NodeSetNodeExtras& extras)
{
    out_.attribute("NodeId", text(space_.node_id(index)));
    QualifiedName name = space_.browse_name(index);
    // A name that begins with digits and a colon needs its index.
    const std::uint16_t name_space = local_(name.namespace_index);
    const bool has_colon = name.name.view().find(':') != std::string_view::npos;
    out_.attribute("BrowseName", (name_space != 0 || has_colon ? std::to_string(name_space) + ':'
                                                               : std::string{}) +
                                     name.name.str());
    variable_attributes(index);
    type_attributes(index);
    if (!extras.method_declaration.is_null()) {
        out_.attribute("MethodDeclarationId", text(extras.method_declaration));
    }
    for (const model::NodeSetAttribute& attribute : extras.attributes) {
        if (is_xml_name(attribute.name)) {
            out_.attribute(attribute.name, attribute.value);
        }
    }
    access_attributes(index);
}

void NodeWriter::access_attributes(model::NodeIndex index)
{
    const model::NodeAccess* const access = space_.node_access(index);
    if (access == nullptr) {
        return;
    }
    if (access->write_mask != 0) {
        out_.attribute("WriteMask", std::to_string(access->write_mask));
    }
    if (access->restrictions) {
        out_.attribute("AccessRestrictions", std::to_string(*access->restrictions));
    }
    if (!access->role_permissions.is_null() && access->role_permissions.empty()) {
        out_.attribute("HasNoPermissions", "true");
    }
}

std::vector<model::NodeSetPermission> NodeWriter::permissions_of(model::NodeIndex index) const
{
    std::vector<model::NodeSetPermission> permissions;
    if (const model::NodeAccess* const access = space_.node_access(index)) {
        for (const RolePermissionType& each : access->role_permissions) {
            permissions.push_back({each.role_id, static_cast<std::uint32_t>(each.permissions)});
        }
    }
    return permissions;
}

void NodeWriter::variable_attributes(model::NodeIndex index)
{
    if (!model::SpaceReader::has_attribute(space_.node_class(index), AttributeId::Value)) {
        return;
    }
    const model::VariableAttributes variable = space_.variable(index);
    out_.attribute("DataType", text(space_.data_type_id(index)));
    if (variable.value_rank != -1) {
        out_.attribute("ValueRank", std::to_string(variable.value_rank));
    }
    if (!variable.array_dimensions.empty()) {
        out_.attribute("ArrayDimensions", dimensions_text(variable.array_dimensions));
    }
    if (space_.node_class(index) != busbar::NodeClass::Variable) {
        return;
    }
    const model::NodeAccess* const access = space_.node_access(index);
    const std::uint32_t level =
        variable.access_level | (access == nullptr ? 0 : access->more_access_levels);
    if (level != 1) {
        out_.attribute("AccessLevel", std::to_string(level));
    }
    if (variable.minimum_sampling_interval != 0) {
        char interval[64];
        out_.attribute("MinimumSamplingInterval",
                       {interval, std::to_chars(interval, interval + sizeof interval,
                                                variable.minimum_sampling_interval)
                                      .ptr});
    }
    if (variable.historizing) {
        out_.attribute("Historizing", "true");
    }
}

void NodeWriter::type_attributes(model::NodeIndex index)
{
    flag_attribute(index, AttributeId::IsAbstract, "IsAbstract", false);
    flag_attribute(index, AttributeId::Symmetric, "Symmetric", false);
    flag_attribute(index, AttributeId::ContainsNoLoops, "ContainsNoLoops", false);
    flag_attribute(index, AttributeId::Executable, "Executable", true);
    const auto notifier = space_.attribute(index, AttributeId::EventNotifier)
                              .value_or(Variant{})
                              .value_or(std::uint8_t{0});
    if (notifier != 0) {
        out_.attribute("EventNotifier", std::to_string(notifier));
    }
}

void NodeWriter::flag_attribute(model::NodeIndex index, AttributeId id, const char* name,
                                bool otherwise)
{
    const bool value = space_.attribute(index, id).value_or(Variant{}).value_or(otherwise);
    if (value != otherwise) {
        out_.attribute(name, value ? "true" : "false");
    }
}

void NodeWriter::localized(const char* name, const busbar::LocalizedText& text)
{
    if (text.text.empty() && text.locale.empty()) {
        return;
    }
    out_.begin(name);
    if (!text.locale.empty()) {
        out_.attribute("Locale", text.locale.view());
    }
    out_.text(text.text.view());
    out_.end();
}

void NodeWriter::names(model::NodeIndex index)
{
    const auto attribute = [&](const char* name, AttributeId id) {
        for (const busbar::LocalizedText& text : space_.texts(index, id)) {
            localized(name, text);
        }
    };
    attribute("DisplayName", AttributeId::DisplayName);
    attribute("Description", AttributeId::Description);
    attribute("InverseName", AttributeId::InverseName);
}

/// A hierarchical reference is listed at its target, any other at its source, if that is written.
bool NodeWriter::is_listed(model::NodeIndex index, const model::Reference& reference) const
{
    const NodeId other = space_.node_id(reference.target);
    if (is_written(other)) {
        const bool is_hierarchical =
            space_.is_subtype_of(reference.type, id::HierarchicalReferences);
        return reference.target == index || is_hierarchical != reference.is_forward;
    }
    return other.namespace_index() == 0 || !requires_written_[other.namespace_index()];
}

void NodeWriter::references(model::NodeIndex index)
{
    out_.begin("References");
    model::ReferenceCursor cursor = space_.references(index);
    while (const auto reference = cursor.next()) {
        if (!is_listed(index, *reference)) {
            continue;
        }
        out_.begin("Reference");
        out_.attribute("ReferenceType", text(space_.node_id(reference->type)));
        if (!reference->is_forward) {
            out_.attribute("IsForward", "false");
        }
        out_.text(text(space_.node_id(reference->target)));
        out_.end();
    }
    out_.end();
}

/// Writes the fields that the type itself adds; the attribute includes those of its supertypes.
void NodeWriter::definition(model::NodeIndex index, const model::NodeSetNodeExtras& extras)
{
    const DataType& type = *types_.find(space_.node_id(index));
    if (!type.definition) {
        return;
    }
    const Kind kind = types_.kind(type.id);
    const bool is_structure = kind == Kind::Structure || kind == Kind::Union;
    const DataType* const above = types_.supertype(type.id);
    const std::size_t inherited = is_structure && above != nullptr && above->definition
                                      ? above->definition->fields.size()
                                      : 0;
    const auto& fields = type.definition->fields;
    if (is_structure && fields.size() <= inherited && extras.definition_name.empty()) {
        return;
    }
    out_.begin("Definition");
    out_.attribute("Name", extras.definition_name.empty() ? type.name : extras.definition_name);
    if (!extras.definition_symbolic_name.empty()) {
        out_.attribute("SymbolicName", extras.definition_symbolic_name);
    }
    if (type.definition->is_union) {
        out_.attribute("IsUnion", "true");
    }
    if (!is_structure && kind != Kind::Enumeration) {
        out_.attribute("IsOptionSet", "true");
    }
    for (std::size_t i = inherited; i < fields.size(); ++i) {
        field(fields[i], i - inherited, is_structure, extras);
    }
    out_.end();
}

void NodeWriter::field(const Field& field, std::size_t position, bool is_structure,
                       const model::NodeSetNodeExtras& extras)
{
    out_.begin("Field");
    out_.attribute("Name", field.name);
    const auto& symbolic_names = extras.field_symbolic_names;
    if (position < symbolic_names.size() && !symbolic_names[position].empty()) {
        out_.attribute("SymbolicName", symbolic_names[position]);
    }
    if (is_structure) {
        out_.attribute("DataType", text(field.data_type));
        if (field.value_rank != -1) {
            out_.attribute("ValueRank", std::to_string(field.value_rank));
        }
        if (!field.array_dimensions.empty()) {
            out_.attribute("ArrayDimensions", dimensions_text(field.array_dimensions));
        }
        if (field.max_string_length != 0) {
            out_.attribute("MaxStringLength", std::to_string(field.max_string_length));
        }
        if (field.is_optional) {
            out_.attribute("IsOptional", "true");
        }
        if (field.allow_sub_types) {
            out_.attribute("AllowSubTypes", "true");
        }
    } else {
        out_.attribute("Value", std::to_string(field.value));
        if (field.display_name.text != field.name || !field.display_name.locale.empty()) {
            localized("DisplayName",
                      {String{field.display_name.locale}, String{field.display_name.text}});
        }
    }
    localized("Description", {String{field.description.locale}, String{field.description.text}});
    out_.end();
}

void NodeWriter::value(model::NodeIndex index)
{
    const Variant value = space_.value(index);
    if (!value.is_null()) {
        out_.begin("Value");
        values_.variant(value);
        out_.end();
    }
}

} // namespace busbar::nodeset
