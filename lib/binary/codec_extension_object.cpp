#include <algorithm>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>

namespace busbar {

namespace {

// Part 6, 5.2.2.15
enum class Encoding : std::uint8_t { None, ByteString, Xml };

/// The length precedes the body, so the body is counted first. While something around it is being
/// counted the length's value does not matter, which limits nested objects to one extra pass.
std::size_t body_size(const binary::Writer& writer, const ExtensionObject& value)
{
    if (writer.is_measuring()) {
        return 0;
    }
    binary::CountingSink sink;
    binary::Writer counter{sink, binary::Writer::Measure{writer}};
    value.type()->encode(counter, value.object());
    return counter.written();
}

void encode_object(binary::Writer& writer, const ExtensionObject& value)
{
    if (!writer.enter()) {
        return;
    }
    writer.length(body_size(writer, value));
    value.type()->encode(writer, value.object());
    writer.leave();
}

void decode_object(binary::Reader& reader, const StructureType& type, NodeId encoding_id,
                   ExtensionObject& value)
{
    const auto length = reader.number<std::int32_t>();
    if (length < 0) {
        if (length == -1) { // a null body
            value = ExtensionObject::from_binary(std::move(encoding_id), {});
        } else {
            reader.fail(status::Bad_DecodingError);
        }
        return;
    }
    if (!reader.charge(type.size) || !reader.enter()) {
        return;
    }
    const std::byte* outer_end = reader.open_window(static_cast<std::size_t>(length));
    void* object = type.create();
    value = ExtensionObject::adopt(type, object, std::move(encoding_id));
    type.decode(reader, object);
    reader.close_window(outer_end); // a newer version of the type may be longer
    reader.leave();
}

void decode_binary(binary::Reader& reader, NodeId encoding_id, ExtensionObject& value)
{
    const StructureType* type =
        reader.types() != nullptr ? reader.types()->find(encoding_id) : nullptr;
    if (type != nullptr) {
        decode_object(reader, *type, std::move(encoding_id), value);
        return;
    }
    ByteString body;
    decode(reader, body);
    value = ExtensionObject::from_binary(std::move(encoding_id), std::move(body));
}

} // namespace

void encode(binary::Writer& writer, const ExtensionObject& value)
{
    encode(writer, value.encoding_id());
    switch (value.body()) {
    case ExtensionObject::Body::None:
        writer.number(Encoding::None);
        break;
    case ExtensionObject::Body::Binary:
        writer.number(Encoding::ByteString);
        encode(writer, value.binary());
        break;
    case ExtensionObject::Body::Xml:
        writer.number(Encoding::Xml);
        encode(writer, value.xml());
        break;
    case ExtensionObject::Body::Object:
        writer.number(Encoding::ByteString);
        encode_object(writer, value);
        break;
    }
}

void decode(binary::Reader& reader, ExtensionObject& value)
{
    NodeId encoding_id;
    decode(reader, encoding_id);
    switch (reader.number<Encoding>()) {
    case Encoding::None:
        value = ExtensionObject::from_id(std::move(encoding_id));
        return;
    case Encoding::ByteString:
        decode_binary(reader, std::move(encoding_id), value);
        return;
    case Encoding::Xml: {
        XmlElement body;
        decode(reader, body);
        value = ExtensionObject::from_xml(std::move(encoding_id), std::move(body));
        return;
    }
    }
    reader.fail(status::Bad_DecodingError);
}

void skip_extension_object(binary::Reader& reader)
{
    NodeId encoding_id;
    decode(reader, encoding_id);
    switch (reader.number<Encoding>()) {
    case Encoding::None:
        return;
    case Encoding::ByteString:
    case Encoding::Xml: {
        const std::int32_t length = reader.text_length(reader.limits().max_byte_string_length);
        reader.skip(static_cast<std::size_t>(std::max(length, 0)));
        return;
    }
    }
    reader.fail(status::Bad_DecodingError);
}

} // namespace busbar
