#include "node_values.hpp"

#include <busbar/binary/codec.hpp>

namespace busbar::generator {

namespace {

using nodeset::Field;
using nodeset::Node;

// NodeIds of the binary encodings of the two kinds of DataTypeDefinition (Part 3, 8.48 and 8.50).
constexpr std::uint32_t structure_definition_encoding = 122;
constexpr std::uint32_t enum_definition_encoding = 123;

/// The fields of a structure: those of its supertypes first (Part 3, 8.48).
std::vector<const Field*> all_fields(const Hierarchy& hierarchy, const Node& node)
{
    constexpr std::size_t most_levels = 100;
    std::vector<const Node*> levels;
    for (const Node* at = &node; at != nullptr && levels.size() < most_levels;
         at = hierarchy.supertype(at->id)) {
        levels.push_back(at);
    }
    std::vector<const Field*> fields;
    for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
        if ((*level)->definition) {
            for (const Field& field : (*level)->definition->fields) {
                fields.push_back(&field);
            }
        }
    }
    return fields;
}

/// StructureType (Part 3, 8.49).
std::int32_t structure_type(bool is_union, const std::vector<const Field*>& fields)
{
    bool has_optional = false;
    bool has_sub_types = false;
    for (const Field* field : fields) {
        has_optional = has_optional || field->is_optional;
        has_sub_types = has_sub_types || field->allow_sub_types;
    }
    if (is_union) {
        return has_sub_types ? 4 : 2;
    }
    return has_optional ? 1 : (has_sub_types ? 3 : 0);
}

/// StructureField (Part 3, 8.51).
void encode_field(binary::Writer& writer, const Field& field)
{
    encode(writer, String{field.name});
    encode(writer, LocalizedText{});
    encode(writer, field.data_type);
    encode(writer, field.value_rank);
    encode(writer, field.array_dimensions.empty() ? Array<std::uint32_t>{}
                                                  : Array<std::uint32_t>{field.array_dimensions});
    encode(writer, field.max_string_length);
    encode(writer, field.is_optional || field.allow_sub_types);
}

void encode_structure(binary::Writer& writer, const Hierarchy& hierarchy, const Node& node,
                      bool is_union)
{
    const auto fields = all_fields(hierarchy, node);
    const Node* const base = hierarchy.supertype(node.id);
    encode(writer, hierarchy.binary_encoding(node.id));
    encode(writer, base == nullptr ? NodeId{} : base->id);
    encode(writer, structure_type(is_union, fields));
    writer.length(fields.size());
    for (const Field* field : fields) {
        encode_field(writer, *field);
    }
}

/// EnumDefinition with its EnumFields (Part 3, 8.50 and 8.52).
void encode_enumeration(binary::Writer& writer, const Node& node)
{
    writer.length(node.definition->fields.size());
    for (const Field& field : node.definition->fields) {
        encode(writer, field.value);
        encode(writer, LocalizedText{String{field.name}});
        encode(writer, LocalizedText{});
        encode(writer, String{field.name});
    }
}

} // namespace

tl::expected<std::string, Failure> NodeValues::definition(const Node& node) const
{
    const Kind kind = hierarchy_.kind(node.id);
    const bool is_structure = (kind == Kind::Structure || kind == Kind::Union) &&
                              !(node.definition && node.definition->is_option_set);
    if (!node.definition && !(is_structure && !node.is_abstract)) {
        return std::string{};
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    if (is_structure) {
        encode_structure(writer, hierarchy_, node,
                         kind == Kind::Union || (node.definition && node.definition->is_union));
    } else {
        encode_enumeration(writer, node);
    }
    const auto body = sink.take(writer.written());
    const Variant value{ExtensionObject::from_binary(
        NodeId{0, is_structure ? structure_definition_encoding : enum_definition_encoding},
        ByteString{std::span{body}})};
    const auto bytes = binary::to_bytes(value);
    if (!bytes) {
        return tl::make_unexpected(node.browse_name + ": its definition cannot be encoded");
    }
    return std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

} // namespace busbar::generator
