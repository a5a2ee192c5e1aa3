#include "data_types.hpp"

#include <busbar/binary/codec.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::nodeset {

namespace {

LocalizedText plain(const busbar::LocalizedText& text)
{
    return {text.locale.str(), text.text.str()};
}

Definition from_structure(const StructureDefinition& from)
{
    using Type = StructureDefinitionType;
    Definition definition;
    definition.is_union =
        from.structure_type == Type::Union || from.structure_type == Type::UnionWithSubtypedValues;
    const bool has_sub_types = from.structure_type == Type::StructureWithSubtypedValues ||
                               from.structure_type == Type::UnionWithSubtypedValues;
    for (const StructureField& field : from.fields) {
        Field& to = definition.fields.emplace_back();
        to.name = field.name.str();
        to.description = plain(field.description);
        to.data_type = field.data_type;
        to.value_rank = field.value_rank;
        to.array_dimensions.assign(field.array_dimensions.begin(), field.array_dimensions.end());
        to.max_string_length = field.max_string_length;
        // IsOptional says one or the other (Part 3, 8.51).
        to.allow_sub_types = has_sub_types && field.is_optional;
        to.is_optional = !has_sub_types && field.is_optional;
    }
    return definition;
}

Definition from_enumeration(const EnumDefinition& from)
{
    Definition definition;
    for (const EnumField& field : from.fields) {
        Field& to = definition.fields.emplace_back();
        to.name = field.name.str();
        to.value = field.value;
        to.display_name = plain(field.display_name);
        to.description = plain(field.description);
    }
    return definition;
}

/// Returns the structure, in any form of the ExtensionObject.
template <typename T>
std::optional<T> body_of(const ExtensionObject& object)
{
    if (const auto* const there = object.get_if<T>()) {
        return *there;
    }
    if (!object.encoding_id().is(T::binary_encoding_id)) {
        return std::nullopt;
    }
    auto decoded = binary::from_bytes<T>(object.binary().span());
    return decoded ? std::optional<T>{std::move(*decoded)} : std::nullopt;
}

void add_encodings(const model::SpaceReader& space, model::NodeIndex node, DataType& type,
                   DataTypeTable& types)
{
    const model::NodeIndex has_encoding = space.find(id::HasEncoding);
    model::ReferenceCursor cursor = space.references(node);
    while (const auto reference = cursor.next()) {
        if (!reference->is_forward || reference->type != has_encoding) {
            continue;
        }
        const NodeId encoding = space.node_id(reference->target);
        const QualifiedName name = space.browse_name(reference->target);
        types.add_encoding(type.id, encoding);
        if (name.name == "Default Binary") {
            type.binary_encoding = encoding;
        } else if (name.name == "Default XML") {
            type.xml_encoding = encoding;
        }
    }
}

} // namespace

std::optional<Definition> definition_from(const ExtensionObject& attribute)
{
    if (const auto structure = body_of<StructureDefinition>(attribute)) {
        return from_structure(*structure);
    }
    if (const auto enumeration = body_of<EnumDefinition>(attribute)) {
        return from_enumeration(*enumeration);
    }
    return std::nullopt;
}

void add_data_types(const model::SpaceReader& space, DataTypeTable& types)
{
    space.for_each([&](model::NodeIndex node) {
        if (space.node_class(node) != busbar::NodeClass::DataType) {
            return;
        }
        DataType type;
        type.id = space.node_id(node);
        const QualifiedName name = space.browse_name(node);
        type.name_space = name.namespace_index;
        type.name = name.name.str();
        const model::NodeIndex above = space.supertype(node);
        type.supertype = above == model::no_node ? NodeId{} : space.node_id(above);
        type.is_abstract = space.is_abstract(node);
        type.is_complete = true;
        const Variant attribute =
            space.attribute(node, AttributeId::DataTypeDefinition).value_or(Variant{});
        if (const auto* const object = attribute.get_if<ExtensionObject>()) {
            if (const auto structure = body_of<StructureDefinition>(*object)) {
                // A small namespace 0 has no nodes for encodings.
                type.binary_encoding = structure->default_encoding_id;
                type.definition = from_structure(*structure);
            } else {
                type.definition = definition_from(*object);
            }
        }
        add_encodings(space, node, type, types);
        types.add(std::move(type));
    });
}

} // namespace busbar::nodeset
