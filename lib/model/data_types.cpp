#include <busbar/model/data_types.hpp>

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::model {

namespace {

using binary::DataTypeEntry;

template <typename Definition>
void take_definition(const ExtensionObject& object, DataTypeEntry& entry)
{
    if (auto definition = binary::structure_of<Definition>(object)) {
        entry.definition = *std::move(definition);
    }
}

/// Returns the object "Default Binary" that HasEncoding refers to.
NodeId binary_encoding(const SpaceReader& space, NodeIndex data_type)
{
    const NodeIndex has_encoding = space.find(id::HasEncoding);
    ReferenceCursor cursor = space.references(data_type);
    while (const auto reference = cursor.next()) {
        if (reference->is_forward && reference->type == has_encoding &&
            space.browse_name(reference->target) == QualifiedName{0, "Default Binary"}) {
            return space.node_id(reference->target);
        }
    }
    return {};
}

DataTypeEntry entry_of(const SpaceReader& space, NodeIndex node)
{
    DataTypeEntry entry;
    entry.id = space.node_id(node);
    entry.name = space.browse_name(node).name;
    const NodeIndex base = space.supertype(node);
    entry.base = base == no_node ? NodeId{} : space.node_id(base);
    entry.encoding_id = binary_encoding(space, node);
    entry.is_abstract = space.is_abstract(node);
    const auto definition = space.attribute(node, AttributeId::DataTypeDefinition);
    const auto* const object = definition ? definition->get_if<ExtensionObject>() : nullptr;
    if (object != nullptr) {
        take_definition<StructureDefinition>(*object, entry);
        take_definition<EnumDefinition>(*object, entry);
    }
    return entry;
}

/// True if a client may take the values for indices of a list.
bool are_numbered_from_zero(const Array<EnumField>& fields)
{
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (fields[i].value != static_cast<std::int64_t>(i)) {
            return false;
        }
    }
    return true;
}

LocalizedText text_of(const EnumField& field)
{
    return field.display_name.text.is_null() ? LocalizedText{field.name} : field.display_name;
}

/// Returns the texts by bit number; empty for bits without a name (Part 3, 5.8.3).
Variant option_set_values(const Array<EnumField>& fields)
{
    constexpr std::int64_t bits = 64;
    Array<LocalizedText> texts;
    texts.clear();
    for (const EnumField& field : fields) {
        if (field.value >= 0 && field.value < bits) {
            const auto bit = static_cast<std::size_t>(field.value);
            texts.resize(std::max(texts.size(), bit + 1));
            texts[bit] = text_of(field);
        }
    }
    return Variant{std::move(texts)};
}

Variant enum_strings(const Array<EnumField>& fields)
{
    Array<LocalizedText> texts;
    texts.clear();
    for (const EnumField& field : fields) {
        texts.push_back(text_of(field));
    }
    return Variant{std::move(texts)};
}

Variant enum_values(const Array<EnumField>& fields)
{
    Array<ExtensionObject> values;
    for (const EnumField& field : fields) {
        EnumValueType value;
        value.value = field.value;
        value.display_name = text_of(field);
        value.description = field.description;
        values.push_back(ExtensionObject::from(std::move(value)));
    }
    return Variant{std::move(values)};
}

/// Returns the id of a node that belongs to a type. It is made of names, so that it stays the same
/// after a restart.
NodeId part_id(const NewNode& type, std::string_view part)
{
    return NodeId{type.browse_name.namespace_index,
                  String{type.browse_name.name.str() + "." + std::string{part}}};
}

StatusCode check_part_id(const SpaceReader& space, const NodeId& id)
{
    if (id.namespace_index() >= space.namespace_count()) {
        return status::Bad_NodeIdInvalid;
    }
    return space.find(id) == no_node ? status::Good : status::Bad_NodeIdExists;
}

/// The Property with the names of an enumeration's values (Part 3, 5.8.3).
struct NamesProperty {
    const char* browse_name;
    std::uint32_t data_type;
    Variant value;
};

NamesProperty names_property(bool is_enumeration, const Array<EnumField>& fields)
{
    if (!is_enumeration) {
        return {"OptionSetValues", id::LocalizedText, option_set_values(fields)};
    }
    if (are_numbered_from_zero(fields)) {
        return {"EnumStrings", id::LocalizedText, enum_strings(fields)};
    }
    return {"EnumValues", id::EnumValueType, enum_values(fields)};
}

/// Tells whether the ValueRank is that of a scalar or an array (Part 3, 8.51). A StructureField
/// whose ValueRank was not set has 0, which no decoder accepts.
bool has_rank(const StructureField& field)
{
    return field.value_rank == -1 || field.value_rank > 0;
}

} // namespace

std::vector<binary::DataTypeEntry> collect_data_types(const SpaceReader& space)
{
    const NodeIndex has_subtype = space.find(id::HasSubtype);
    std::vector<binary::DataTypeEntry> entries;
    std::vector<NodeIndex> open{space.find(id::BaseDataType)};
    while (!open.empty() && open.back() != no_node) {
        const NodeIndex node = open.back();
        open.pop_back();
        entries.push_back(entry_of(space, node));
        ReferenceCursor cursor = space.references(node);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward && reference->type == has_subtype) {
                open.push_back(reference->target);
            }
        }
    }
    return entries;
}

const binary::DynamicTypes& DataTypes::of(const SpaceReader& space)
{
    if (seen_types_ != space.type_count()) {
        seen_types_ = space.type_count();
        compiled_ = binary::DynamicTypes::compile(collect_data_types(space));
    }
    return compiled_;
}

Result<NodeIndex> add_structure_type(AddressSpace& space, const NewNode& node,
                                     StructureDefinition definition, bool is_abstract)
{
    if (!std::all_of(definition.fields.begin(), definition.fields.end(), has_rank)) {
        return fail(status::Bad_NodeAttributesInvalid);
    }
    NewNode encoding;
    encoding.id = definition.default_encoding_id;
    if (is_abstract) {
        definition.default_encoding_id = NodeId{};
    } else if (encoding.id.is_null()) {
        encoding.id = definition.default_encoding_id = part_id(node, "Default Binary");
    }
    if (const auto bad = check_part_id(space, encoding.id); !is_abstract && bad.is_bad()) {
        return fail(bad);
    }
    if (space.exists(node.parent)) {
        definition.base_data_type = space.node_id(node.parent);
    }
    const auto type =
        space.add_data_type(node, {ExtensionObject::from(std::move(definition)), is_abstract});
    if (!type || is_abstract) {
        return type;
    }
    encoding.parent = *type;
    encoding.browse_name = QualifiedName{0, "Default Binary"};
    encoding.reference_type = NodeId{0, id::HasEncoding};
    const auto added =
        space.add_object(encoding, NewObject{NodeId{0, id::DataTypeEncodingType}, 0});
    return added ? type : added;
}

Result<NodeIndex> add_enumeration_type(AddressSpace& space, const NewNode& node,
                                       EnumDefinition definition)
{
    const bool is_enumeration =
        space.exists(node.parent) && space.built_in_type_of(node.parent) == BuiltInType::Int32;
    NamesProperty names = names_property(is_enumeration, definition.fields);
    NewNode property;
    property.id = part_id(node, names.browse_name);
    property.browse_name = QualifiedName{0, names.browse_name};
    if (const auto bad = check_part_id(space, property.id); bad.is_bad()) {
        return fail(bad);
    }
    const auto type =
        space.add_data_type(node, {ExtensionObject::from(std::move(definition)), false});
    if (!type) {
        return type;
    }
    property.parent = *type;
    NewVariable variable;
    variable.value_rank = 1;
    variable.data_type = NodeId{0, names.data_type};
    variable.value = std::move(names.value);
    const auto added = space.add_property(property, std::move(variable));
    return added ? type : added;
}

} // namespace busbar::model
