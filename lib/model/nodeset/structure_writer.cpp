#include "value_writer.hpp"

#include <algorithm>
#include <array>

#include <core/base64.hpp>

#include "built_in_visit.hpp"

namespace busbar::nodeset {

namespace {

constexpr unsigned max_depth = 32;
constexpr std::size_t max_value_fields = 4'000'000;

struct XmlEncoding {
    std::uint32_t data_type;
    std::uint32_t encoding;
};
/// The XML encodings of namespace 0 that models use most; Busbar has no nodes for them.
constexpr std::array<XmlEncoding, 3> xml_encodings = {{{296, 297}, {887, 888}, {7594, 7616}}};

/// Returns the id of the structure in XML: that of its XML encoding if there is one.
NodeId xml_type_id(const DataType& type)
{
    if (!type.xml_encoding.is_null()) {
        return type.xml_encoding;
    }
    for (const XmlEncoding& known : xml_encodings) {
        if (type.id.is(known.data_type)) {
            return NodeId{0, known.encoding};
        }
    }
    return type.id;
}

bool is_binary(const ExtensionObject& value)
{
    return value.body() == ExtensionObject::Body::Binary || value.type() != nullptr;
}

/// Returns the bytes of a body, in any form; null if it has none.
ByteString binary_body(const ExtensionObject& value)
{
    if (!is_binary(value)) {
        return {};
    }
    if (value.type() == nullptr) {
        return value.binary();
    }
    binary::VectorSink sink;
    binary::Writer writer{sink};
    value.type()->encode(writer, value.object());
    const auto bytes = sink.take(writer.written());
    return ByteString{std::span{bytes}};
}

} // namespace

void ValueWriter::body(const ExtensionObject& value)
{
    const DataType* const type = types_.find_encoded(value.encoding_id());
    const ByteString bytes = binary_body(value);
    if (is_binary(value) && type != nullptr && structure_body(*type, bytes)) {
        return;
    }
    out_.begin("TypeId");
    contents(value.encoding_id());
    out_.end();
    if (value.body() == ExtensionObject::Body::None) {
        return;
    }
    out_.begin("Body");
    if (is_binary(value)) {
        element("ByteString", bytes);
    } else {
        contents(value.xml());
    }
    out_.end();
}

/// Returns false, with nothing written, if the bytes are not a structure of the type.
bool ValueWriter::structure_body(const DataType& type, const ByteString& bytes)
{
    const Kind kind = types_.kind(type.id);
    if (kind != Kind::Structure && kind != Kind::Union && kind != Kind::OptionSetStructure) {
        return false;
    }
    if (depth_ == 0) {
        fields_left_ = max_value_fields;
    }
    const XmlOut::Mark mark = out_.mark();
    out_.begin("TypeId");
    contents(xml_type_id(type));
    out_.end();
    out_.begin("Body");
    binary::Reader reader{bytes.span()};
    structure(reader, type.name, type);
    out_.end();
    if (!reader.ok() || reader.remaining() != 0) {
        out_.back(mark);
        return false;
    }
    return true;
}

void ValueWriter::structure(binary::Reader& reader, std::string_view name, const DataType& type)
{
    if (depth_ == max_depth || !is_xml_name(name)) {
        reader.fail(status::Bad_EncodingLimitsExceeded);
        return;
    }
    ++depth_;
    out_.begin(name);
    fields(reader, type);
    out_.end();
    --depth_;
}

void ValueWriter::fields(binary::Reader& reader, const DataType& type)
{
    if (types_.kind(type.id) == Kind::OptionSetStructure) {
        Field bits;
        bits.data_type = NodeId{0, static_cast<std::uint32_t>(BuiltInType::ByteString)};
        for (const char* const name : {"Value", "ValidBits"}) {
            bits.name = name;
            field(reader, bits);
        }
        return;
    }
    const auto all = types_.fields(type.id);
    if (!reader.ok() || all.size() >= fields_left_) {
        reader.fail(status::Bad_EncodingLimitsExceeded);
        return;
    }
    fields_left_ -= all.size() + 1;
    if (types_.is_union(type.id)) {
        union_field(reader, all);
        return;
    }
    const bool has_optional =
        std::any_of(all.begin(), all.end(), [](const Field* f) { return f->is_optional; });
    std::uint32_t mask = 0;
    if (has_optional) {
        mask = reader.number<std::uint32_t>();
        element("EncodingMask", mask);
    }
    for (const Field* one : all) {
        const bool is_there = !one->is_optional || (mask & 1U) != 0;
        mask >>= one->is_optional ? 1U : 0U;
        if (is_there) {
            field(reader, *one);
        }
    }
    if (mask != 0) {
        reader.fail(status::Bad_DecodingError);
    }
}

void ValueWriter::union_field(binary::Reader& reader, const std::vector<const Field*>& fields)
{
    const auto chosen = reader.number<std::uint32_t>();
    element("SwitchField", chosen);
    if (chosen > fields.size()) {
        reader.fail(status::Bad_DecodingError);
    } else if (chosen != 0) {
        field(reader, *fields[chosen - 1]);
    }
}

void ValueWriter::field(binary::Reader& reader, const Field& field)
{
    const DataType* const type = types_.find(field.data_type);
    const std::string_view element_name =
        type == nullptr ? std::string_view{"Element"} : std::string_view{type->name};
    if (!is_xml_name(field.name) || !is_xml_name(element_name)) {
        // Then the structure is written as bytes.
        reader.fail(status::Bad_EncodingError);
        return;
    }
    if (field.value_rank < 0) {
        scalar(reader, field.name, field);
        return;
    }
    if (field.value_rank > 1) {
        matrix_field(reader, field, element_name);
        return;
    }
    const std::int32_t count = reader.array_length(1, 1);
    if (count < 0) {
        return;
    }
    out_.begin(field.name);
    for (std::int32_t i = 0; i < count && reader.ok(); ++i) {
        scalar(reader, element_name, field);
    }
    out_.end();
}

void ValueWriter::matrix_field(binary::Reader& reader, const Field& field,
                               std::string_view element_name)
{
    Array<std::int32_t> dimensions;
    decode(reader, dimensions);
    if (dimensions.is_null()) {
        return;
    }
    std::uint64_t count = 1;
    out_.begin(field.name);
    out_.begin("Dimensions");
    for (const std::int32_t dimension : dimensions) {
        element("UInt32", dimension);
        count = std::min<std::uint64_t>(count * static_cast<std::uint64_t>(std::max(dimension, 0)),
                                        UINT32_MAX);
    }
    out_.end();
    if (dimensions.size() < 2 || count > reader.remaining()) {
        reader.fail(status::Bad_DecodingError);
    }
    out_.begin("Elements");
    for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
        scalar(reader, element_name, field);
    }
    out_.end();
    out_.end();
}

void ValueWriter::scalar(binary::Reader& reader, std::string_view name, const Field& field)
{
    const FieldForm form = types_.form(field);
    if (form.form == FieldForm::Class::Structure) {
        structure(reader, name, *form.structure);
        return;
    }
    if (form.form == FieldForm::Class::Unknown) {
        reader.fail(status::Bad_DecodingError);
        return;
    }
    visit_built_in(form.built_in, [&]<typename T>(std::type_identity<T>) {
        T value{};
        decode(reader, value);
        if (reader.ok()) {
            element(name, value);
        }
    });
}

} // namespace busbar::nodeset
