#include <memory>
#include <utility>

#include <busbar/binary/codec.hpp>

namespace busbar {

namespace {

// Part 6, 5.2.2.9
enum class Form : std::uint8_t { TwoByte, FourByte, Numeric, String, Guid, ByteString };
constexpr unsigned namespace_uri_flag = 0x80; // Part 6, 5.2.2.10
constexpr unsigned server_index_flag = 0x40;

void encode_form(binary::Writer& writer, Form form, unsigned flags)
{
    writer.number(static_cast<std::uint8_t>(static_cast<unsigned>(form) | flags));
}

void encode_numeric(binary::Writer& writer, std::uint16_t index, std::uint32_t identifier,
                    unsigned flags)
{
    if (index == 0 && identifier <= 0xFF) {
        encode_form(writer, Form::TwoByte, flags);
        writer.number(static_cast<std::uint8_t>(identifier));
    } else if (index <= 0xFF && identifier <= 0xFFFF) {
        encode_form(writer, Form::FourByte, flags);
        writer.number(static_cast<std::uint8_t>(index));
        writer.number(static_cast<std::uint16_t>(identifier));
    } else {
        encode_form(writer, Form::Numeric, flags);
        writer.number(index);
        writer.number(identifier);
    }
}

void encode_node_id(binary::Writer& writer, const NodeId& value, std::uint16_t index,
                    unsigned flags)
{
    switch (value.id_type()) {
    case IdType::Numeric:
        encode_numeric(writer, index, value.numeric(), flags);
        break;
    case IdType::String:
        encode_form(writer, Form::String, flags);
        writer.number(index);
        encode(writer, value.string());
        break;
    case IdType::Guid:
        encode_form(writer, Form::Guid, flags);
        writer.number(index);
        encode(writer, value.guid());
        break;
    case IdType::Opaque:
        encode_form(writer, Form::ByteString, flags);
        writer.number(index);
        encode(writer, value.opaque());
        break;
    }
}

/// Constructs `value` in place: a temporary NodeId would be moved and destroyed for each item of a
/// request.
template <typename T>
void make(NodeId& value, std::uint16_t index, T identifier)
{
    std::destroy_at(&value);
    std::construct_at(&value, index, std::move(identifier));
}

template <typename T>
void decode_identifier(binary::Reader& reader, NodeId& value)
{
    const auto index = reader.number<std::uint16_t>();
    T identifier;
    decode(reader, identifier);
    make(value, index, std::move(identifier));
}

void decode_node_id(binary::Reader& reader, unsigned form, NodeId& value)
{
    switch (static_cast<Form>(form)) {
    case Form::TwoByte:
        return make(value, 0, std::uint32_t{reader.number<std::uint8_t>()});
    case Form::FourByte: {
        const auto index = reader.number<std::uint8_t>();
        return make(value, index, std::uint32_t{reader.number<std::uint16_t>()});
    }
    case Form::Numeric: {
        const auto index = reader.number<std::uint16_t>();
        return make(value, index, reader.number<std::uint32_t>());
    }
    case Form::String:
        return decode_identifier<String>(reader, value);
    case Form::Guid:
        return decode_identifier<Guid>(reader, value);
    case Form::ByteString:
        return decode_identifier<ByteString>(reader, value);
    }
    reader.fail(status::Bad_DecodingError);
    make(value, 0, 0U);
}

} // namespace

void encode(binary::Writer& writer, const NodeId& value)
{
    encode_node_id(writer, value, value.namespace_index(), 0);
}

void encode(binary::Writer& writer, const ExpandedNodeId& value)
{
    // Part 6, 5.2.2.10: with a URI the index is 0.
    const bool has_uri = !value.namespace_uri.is_null();
    const unsigned flags =
        (has_uri ? namespace_uri_flag : 0U) | (value.server_index != 0 ? server_index_flag : 0U);
    const std::uint16_t index = has_uri ? std::uint16_t{0} : value.node_id.namespace_index();
    encode_node_id(writer, value.node_id, index, flags);
    if (has_uri) {
        encode(writer, value.namespace_uri);
    }
    if (value.server_index != 0) {
        writer.number(value.server_index);
    }
}

void decode(binary::Reader& reader, NodeId& value)
{
    decode_node_id(reader, reader.number<std::uint8_t>(), value);
}

void decode(binary::Reader& reader, ExpandedNodeId& value)
{
    const unsigned form = reader.number<std::uint8_t>();
    decode_node_id(reader, form & ~(namespace_uri_flag | server_index_flag), value.node_id);
    value.namespace_uri.reset();
    if ((form & namespace_uri_flag) != 0) {
        decode(reader, value.namespace_uri);
    }
    value.server_index = (form & server_index_flag) != 0 ? reader.number<std::uint32_t>() : 0;
}

} // namespace busbar
