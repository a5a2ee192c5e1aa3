#include "data_types.hpp"

#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/core/detail/basic_ids.hpp>

namespace busbar::nodeset {

namespace {

// NodeIds of the binary encodings of the two kinds of DataTypeDefinition (Part 3, 8.48 and 8.50).
constexpr std::uint32_t structure_definition_encoding =
    busbar::detail::basic_id::StructureDefinition_Encoding_DefaultBinary;
constexpr std::uint32_t enum_definition_encoding =
    busbar::detail::basic_id::EnumDefinition_Encoding_DefaultBinary;

/// StructureType (Part 3, 8.49).
std::int32_t structure_type(bool is_union, const std::vector<const Field*>& fields)
{
    const auto any = [&](auto property) {
        return std::any_of(fields.begin(), fields.end(),
                           [&](const Field* field) { return field->*property; });
    };
    const bool has_sub_types = any(&Field::allow_sub_types);
    if (is_union) {
        return has_sub_types ? 4 : 2;
    }
    return any(&Field::is_optional) ? 1 : (has_sub_types ? 3 : 0);
}

busbar::LocalizedText localized(const LocalizedText& text)
{
    return {text.locale.empty() ? String{} : String{text.locale},
            text.text.empty() ? String{} : String{text.text}};
}

/// StructureField (Part 3, 8.51).
void encode_field(binary::Writer& writer, const Field& field)
{
    encode(writer, String{field.name});
    encode(writer, localized(field.description));
    encode(writer, field.data_type);
    encode(writer, field.value_rank);
    encode(writer, field.array_dimensions.empty() ? Array<std::uint32_t>{}
                                                  : Array<std::uint32_t>{field.array_dimensions});
    encode(writer, field.max_string_length);
    encode(writer, field.is_optional || field.allow_sub_types);
}

void encode_structure(binary::Writer& writer, const DataTypeTable& types, const DataType& type)
{
    const auto fields = types.fields(type.id);
    encode(writer, type.binary_encoding);
    encode(writer, type.supertype);
    encode(writer, structure_type(types.is_union(type.id), fields));
    writer.length(fields.size());
    for (const Field* field : fields) {
        encode_field(writer, *field);
    }
}

/// EnumDefinition with its EnumFields (Part 3, 8.50 and 8.52).
void encode_enumeration(binary::Writer& writer, const Definition& definition)
{
    writer.length(definition.fields.size());
    for (const Field& field : definition.fields) {
        encode(writer, field.value);
        encode(writer, field.display_name.text.empty() ? busbar::LocalizedText{String{field.name}}
                                                       : localized(field.display_name));
        encode(writer, localized(field.description));
        encode(writer, String{field.name});
    }
}

} // namespace

ExtensionObject definition_of(const DataTypeTable& types, const DataType& type)
{
    const Kind kind = types.kind(type.id);
    // OptionSet itself is a structure; what derives from it has names of bits (Part 3, 5.8.3).
    const bool has_fields = kind == Kind::Structure || kind == Kind::Union ||
                            type.id.is(busbar::detail::basic_id::OptionSet);
    const bool is_structure = has_fields && !(type.definition && type.definition->is_option_set);
    if (!type.definition && !(is_structure && !type.is_abstract)) {
        return {};
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    if (is_structure) {
        encode_structure(writer, types, type);
    } else {
        encode_enumeration(writer, *type.definition);
    }
    const auto body = sink.take(writer.written());
    return ExtensionObject::from_binary(
        NodeId{0, is_structure ? structure_definition_encoding : enum_definition_encoding},
        ByteString{std::span{body}});
}

} // namespace busbar::nodeset
