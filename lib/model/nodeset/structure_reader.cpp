#include "value_reader.hpp"

#include <algorithm>
#include <unordered_map>

#include "xml_text.hpp"

namespace busbar::nodeset {

namespace {

/// The elements of a structure by name, so that a long one is not searched again for each field.
class FieldElements {
public:
    explicit FieldElements(const Element& xml) : xml_{xml}
    {
        constexpr std::size_t few = 16;
        if (xml.children.size() > few) {
            for (const Element& child : xml.children) {
                by_name_.emplace(child.name, &child);
            }
        }
    }

    [[nodiscard]] const Element* find(const std::string& name) const
    {
        if (by_name_.empty()) {
            return xml_.child(name);
        }
        const auto found = by_name_.find(name);
        return found == by_name_.end() ? nullptr : found->second;
    }

private:
    const Element& xml_;
    std::unordered_map<std::string_view, const Element*> by_name_;
};

bool is_absent(const Element* found)
{
    return found == nullptr || (found->is_nil && found->text.empty());
}

} // namespace

/// Returns the DataType for an ExtensionObject's TypeId, which names the XML encoding or the
/// DataType; Busbar has no nodes for XML encodings of namespace 0.
const DataType* XmlValueReader::structure_type(const Element& xml, const Element& structure)
{
    NodeId type_id;
    if (const Element* const found = xml.child("TypeId")) {
        read(*found, type_id, 0);
    }
    if (type_id.is_null()) {
        for (const std::uint16_t index : namespaces_) {
            if (const DataType* const type = types_.find_named(index, structure.name)) {
                return type;
            }
        }
        return nullptr;
    }
    if (const DataType* const type = types_.find_encoded(type_id)) {
        return type;
    }
    return types_.find_named(type_id.namespace_index(), structure.name);
}

void XmlValueReader::read(const Element& xml, ExtensionObject& value, unsigned depth)
{
    NodeId type_id;
    if (const Element* const found = xml.child("TypeId")) {
        read(*found, type_id, depth);
    }
    const Element* const body = xml.child("Body");
    if (body == nullptr || body->children.empty()) {
        value = ExtensionObject::from_id(std::move(type_id));
        return;
    }
    const Element& structure = body->children.front();
    if (structure.name == "ByteString") {
        // Part 6, 5.3.1.16: the body in OPC UA Binary.
        ByteString bytes;
        read(structure, bytes, depth);
        value = ExtensionObject::from_binary(std::move(type_id), std::move(bytes));
        return;
    }
    const DataType* const type = structure_type(xml, structure);
    const Kind kind = type == nullptr ? Kind::Unknown : types_.kind(type->id);
    if (kind != Kind::Structure && kind != Kind::Union && kind != Kind::OptionSetStructure) {
        value = ExtensionObject::from_xml(std::move(type_id), XmlElement{String{body->raw}});
        return;
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode_structure(writer, structure, *type, depth + 1);
    const auto bytes = sink.take(writer.written());
    value = ExtensionObject::from_binary(type->binary_encoding.is_null() ? type->id
                                                                         : type->binary_encoding,
                                         ByteString{std::span{bytes}});
}

/// A file may make one type of another many times over, so that few bytes of a value ask for the
/// same type very often.
const XmlValueReader::Structure& XmlValueReader::structure_of(const DataType& type)
{
    const auto [known, is_new] = structures_.try_emplace(&type);
    Structure& structure = known->second;
    if (is_new) {
        structure.kind = types_.kind(type.id);
        structure.is_union = types_.is_union(type.id);
        structure.fields = types_.fields(type.id);
        structure.forms.reserve(structure.fields.size());
        for (const Field* field : structure.fields) {
            structure.forms.push_back(types_.form(*field));
            structure.has_optional = structure.has_optional || field->is_optional;
        }
    }
    return structure;
}

void XmlValueReader::encode_structure(binary::Writer& writer, const Element& xml,
                                      const DataType& type, unsigned depth)
{
    if (depth > max_depth) {
        fail(xml, "structures less deep");
        return;
    }
    const Structure& structure = structure_of(type);
    if (structure.kind == Kind::OptionSetStructure) {
        // Its only fields are those of OptionSet; the Definition names the bits (Part 3, 8.40).
        ByteString value = read_child<ByteString>(xml, "Value", depth);
        encode(writer, value);
        encode(writer, read_child<ByteString>(xml, "ValidBits", depth));
        return;
    }
    const auto& fields = structure.fields;
    const std::size_t count = fields.size() + 1;
    if (count > fields_left_) {
        fields_left_ = 0;
        fail(xml, "structures of fewer fields in all");
        return;
    }
    fields_left_ -= count;
    if (structure.is_union) {
        encode_union(writer, xml, structure, depth);
        return;
    }
    const std::uint32_t mask = structure.has_optional ? encoding_mask(xml, fields) : 0;
    if (structure.has_optional) {
        encode(writer, mask);
    }
    const FieldElements elements{xml};
    std::uint32_t bit = 1;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const Field& field = *fields[i];
        const bool is_there = !field.is_optional || (mask & bit) != 0;
        bit <<= field.is_optional ? 1U : 0U;
        if (is_there) {
            encode_field(writer, elements.find(field.name), field, structure.forms[i], depth);
        }
    }
}

/// Returns one bit for each optional field, in their order (Part 6, 5.2.7 and 5.3.6); without an
/// <EncodingMask> those of the present fields.
std::uint32_t XmlValueReader::encoding_mask(const Element& xml,
                                            const std::vector<const Field*>& fields)
{
    const auto count =
        std::count_if(fields.begin(), fields.end(), [](const Field* f) { return f->is_optional; });
    if (count > 32) {
        fail(xml, "a structure of at most 32 optional fields");
        return 0;
    }
    const std::uint32_t all = count == 32 ? UINT32_MAX : (1U << static_cast<unsigned>(count)) - 1U;
    if (xml.child("EncodingMask") != nullptr) {
        return read_child<std::uint32_t>(xml, "EncodingMask", 0) & all;
    }
    const FieldElements elements{xml};
    std::uint32_t mask = 0;
    std::uint32_t bit = 1;
    for (const Field* field : fields) {
        if (field->is_optional) {
            mask |= elements.find(field->name) != nullptr ? bit : 0U;
            bit <<= 1U;
        }
    }
    return mask;
}

/// Encodes the <SwitchField> and the field it names (Part 6, 5.2.8 and 5.3.7); without it the one
/// present field.
void XmlValueReader::encode_union(binary::Writer& writer, const Element& xml, const Structure& type,
                                  unsigned depth)
{
    const auto& fields = type.fields;
    std::uint32_t chosen = 0;
    if (xml.child("SwitchField") != nullptr) {
        chosen = read_child<std::uint32_t>(xml, "SwitchField", depth);
    } else if (!xml.children.empty()) {
        const std::string& name = xml.children.front().name;
        const auto found = std::find_if(fields.begin(), fields.end(),
                                        [&](const Field* field) { return field->name == name; });
        chosen = static_cast<std::uint32_t>(found - fields.begin()) + 1;
    }
    if (chosen > fields.size()) {
        fail(xml, "one of the " + std::to_string(fields.size()) + " fields of the union");
        return;
    }
    encode(writer, chosen);
    if (chosen != 0) {
        const Field& field = *fields[chosen - 1];
        encode_field(writer, xml.child(field.name), field, type.forms[chosen - 1], depth);
    }
}

void XmlValueReader::encode_field(binary::Writer& writer, const Element* found, const Field& field,
                                  const FieldForm& form, unsigned depth)
{
    if (field.value_rank < 0) {
        if (is_absent(found)) {
            const Element absent{field.name, "",    {}, found == nullptr ? 0 : found->line,
                                 true,       false, {}};
            encode_scalar(writer, absent, field, form, depth);
        } else {
            encode_scalar(writer, *found, field, form, depth);
        }
        return;
    }
    if (field.value_rank > 1) {
        if (is_absent(found)) {
            writer.number(std::int32_t{-1});
        } else {
            encode_matrix(writer, *found, field, form, depth);
        }
        return;
    }
    if (found == nullptr || found->says_nil) {
        writer.number(std::int32_t{-1});
        return;
    }
    writer.length(found->children.size());
    for (const Element& child : found->children) {
        encode_scalar(writer, child, field, form, depth);
    }
}

/// Encodes the dimensions as an array of Int32 and the elements (Part 6, 5.2.5).
void XmlValueReader::encode_matrix(binary::Writer& writer, const Element& xml, const Field& field,
                                   const FieldForm& form, unsigned depth)
{
    const Element* const sizes = xml.child("Dimensions");
    const Element* const elements = xml.child("Elements");
    if (sizes == nullptr || elements == nullptr) {
        fail(xml, "<Dimensions> and <Elements>");
        return;
    }
    std::uint64_t count = 1;
    writer.length(sizes->children.size());
    for (const Element& size : sizes->children) {
        std::int32_t length = 0;
        read(size, length, depth);
        encode(writer, length);
        count = std::min<std::uint64_t>(count * static_cast<std::uint64_t>(std::max(length, 0)),
                                        UINT32_MAX);
    }
    if (sizes->children.size() < 2 || count != elements->children.size()) {
        fail(xml, "as many <Elements> as the two or more <Dimensions> say");
        return;
    }
    for (const Element& child : elements->children) {
        encode_scalar(writer, child, field, form, depth);
    }
}

void XmlValueReader::encode_scalar(binary::Writer& writer, const Element& xml, const Field& field,
                                   const FieldForm& form, unsigned depth)
{
    switch (form.form) {
    case FieldForm::Class::Unknown:
        fail(xml, "a field whose DataType is known");
        break;
    case FieldForm::Class::Enumeration:
        encode_enumeration(writer, xml, field.data_type);
        break;
    case FieldForm::Class::BuiltIn:
        encode_built_in(writer, xml, form.built_in, depth);
        break;
    case FieldForm::Class::Structure:
        encode_structure(writer, xml, *form.structure, depth + 1);
        break;
    }
}

void XmlValueReader::encode_built_in(binary::Writer& writer, const Element& xml, BuiltInType type,
                                     unsigned depth)
{
    Element zero;
    const bool is_number = type <= BuiltInType::Double;
    const bool needs_zero =
        xml.is_nil && xml.text.empty() && xml.children.empty() &&
        (is_number || type == BuiltInType::DateTime || type == BuiltInType::Guid);
    if (needs_zero) {
        zero = xml;
        zero.text = is_number
                        ? "0"
                        : (type == BuiltInType::DateTime ? "1601-01-01"
                                                         : "00000000-0000-0000-0000-000000000000");
    }
    const Variant value = of_type(needs_zero ? zero : xml, busbar::name(type), false, depth);
    // A Variant's one byte of type is not part of a field.
    if (type == BuiltInType::Variant) {
        encode(writer, value);
        return;
    }
    const auto bytes = binary::to_bytes(value);
    if (bytes && !bytes->empty()) {
        writer.bytes(std::span{*bytes}.subspan(1));
    }
}

/// "Name_3", "3" or "Name" (Part 6, 5.3.3).
void XmlValueReader::encode_enumeration(binary::Writer& writer, const Element& xml,
                                        const NodeId& type)
{
    std::int32_t value = 0;
    const std::string_view text = trimmed(xml.text);
    const std::size_t digits = text.find_last_of('_') + 1;
    if (!text.empty() && !to_number(text.substr(digits), value)) {
        const auto fields = types_.fields(type);
        const auto found = std::find_if(fields.begin(), fields.end(),
                                        [&](const Field* field) { return field->name == text; });
        if (found == fields.end()) {
            fail(xml, "a value of the enumeration such as Name_3");
            return;
        }
        value = static_cast<std::int32_t>((*found)->value);
    }
    encode(writer, value);
}

} // namespace busbar::nodeset
