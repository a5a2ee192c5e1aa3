#include "structure_codec.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include <busbar/binary/codec.hpp>

#include "core/utf8.hpp"
#include "image_types.hpp"

namespace busbar::server::detail {

namespace {

void encode_members(binary::Writer& writer, const ImageStructure& structure, const std::byte* from);

template <typename T>
void encode_elements(binary::Writer& writer, const ImagePlace& place, const std::byte* from)
{
    for (std::uint32_t i = 0; i < place.elements; ++i, from += place.stride) {
        if constexpr (is_image_text<T>) {
            encode(writer, borrow_text<T>(from, place.capacity));
        } else {
            T value{};
            std::memcpy(&value, from, sizeof value);
            encode(writer, value);
        }
    }
}

void encode_member(binary::Writer& writer, const ImagePlace& place, const std::byte* from)
{
    if (place.dimensions.size() > 1) {
        writer.length(place.dimensions.size());
    }
    for (const std::uint32_t dimension : place.dimensions) {
        writer.number(static_cast<std::int32_t>(dimension));
    }
    if (place.is_structure()) {
        for (std::uint32_t i = 0; i < place.elements; ++i, from += place.stride) {
            encode_members(writer, *place.structure, from);
        }
        return;
    }
    visit_image_type(
        place.type,
        [&](auto tag) { encode_elements<typename decltype(tag)::type>(writer, place, from); },
        [] {});
}

void encode_members(binary::Writer& writer, const ImageStructure& structure, const std::byte* from)
{
    for (const ImagePlace& member : structure.members()) {
        encode_member(writer, member, from + member.offset);
    }
}

bool is_valid_place(const ImagePlace& place, const std::byte* from)
{
    const bool is_text = place.type == BuiltInType::String || place.type == BuiltInType::XmlElement;
    if (!is_text && !place.is_structure()) {
        return true;
    }
    for (std::uint32_t i = 0; i < place.elements; ++i, from += place.stride) {
        if (is_text ? !busbar::detail::is_utf8(borrow_text<String>(from, place.capacity).view())
                    : !has_valid_texts(*place.structure, from)) {
            return false;
        }
    }
    return true;
}

void decode_members(binary::Reader& reader, const ImageStructure& structure, std::byte* to);

template <typename T>
void decode_elements(binary::Reader& reader, const ImagePlace& place, std::byte* to)
{
    for (std::uint32_t i = 0; i < place.elements && reader.ok(); ++i, to += place.stride) {
        T value{};
        decode(reader, value);
        if constexpr (!is_image_text<T>) {
            if (!is_in_range(place, value)) {
                reader.fail(status::Bad_OutOfRange);
            }
            std::memcpy(to, &value, sizeof value);
        } else if (!text_has_room(place, value)) {
            reader.fail(status::Bad_OutOfRange);
        } else {
            put_text(to, text_of(value));
        }
    }
}

/// Checks that the dimensions on the wire are those of the member.
void check_dimensions(binary::Reader& reader, const ImagePlace& place)
{
    const auto expect = [&](std::size_t size) {
        if (reader.number<std::int32_t>() != static_cast<std::int32_t>(size)) {
            reader.fail(status::Bad_TypeMismatch);
        }
    };
    if (place.dimensions.size() > 1) {
        expect(place.dimensions.size());
    }
    for (const std::uint32_t dimension : place.dimensions) {
        expect(dimension);
    }
}

void decode_member(binary::Reader& reader, const ImagePlace& place, std::byte* to)
{
    check_dimensions(reader, place);
    if (place.is_structure()) {
        for (std::uint32_t i = 0; i < place.elements && reader.ok(); ++i, to += place.stride) {
            decode_members(reader, *place.structure, to);
        }
        return;
    }
    visit_image_type(
        place.type,
        [&](auto tag) { decode_elements<typename decltype(tag)::type>(reader, place, to); }, [] {});
}

void decode_members(binary::Reader& reader, const ImageStructure& structure, std::byte* to)
{
    for (const ImagePlace& member : structure.members()) {
        if (!reader.ok()) {
            return;
        }
        decode_member(reader, member, to + member.offset);
    }
}

StatusCode decode_body(const ImageStructure& structure, std::span<const std::byte> body,
                       std::byte* to)
{
    // Nothing is allocated: texts are checked against their capacity before they are copied.
    binary::DecodeLimits limits;
    limits.max_string_length = limits.max_byte_string_length = INT32_MAX;
    binary::Reader reader{body, binary::Strings::Borrow, nullptr, limits};
    decode_members(reader, structure, to);
    if (reader.ok() && reader.remaining() != 0) {
        return status::Bad_DecodingError;
    }
    return reader.status();
}

} // namespace

bool has_valid_texts(const ImageStructure& structure, const std::byte* from)
{
    const auto members = structure.members();
    return !structure.has_texts() ||
           std::all_of(members.begin(), members.end(), [&](const ImagePlace& member) {
               return is_valid_place(member, from + member.offset);
           });
}

std::size_t encode_structure(const ImageStructure& structure, const std::byte* from,
                             std::span<std::byte> to)
{
    binary::SpanSink sink{to};
    binary::Writer writer{sink};
    encode_members(writer, structure, from);
    return writer.written();
}

StatusCode decode_structure(const ImageStructure& structure, const ExtensionObject& object,
                            std::byte* to)
{
    if (object.encoding_id() != structure.encoding_id()) {
        return status::Bad_TypeMismatch;
    }
    switch (object.body()) {
    case ExtensionObject::Body::Binary:
        return decode_body(structure, object.binary().span(), to);
    case ExtensionObject::Body::Object: {
        binary::VectorSink sink{static_cast<std::size_t>(structure.max_wire_size())};
        binary::Writer writer{sink};
        object.type()->encode(writer, object.object());
        if (!writer.ok()) { // longer than any value that fits
            return status::Bad_OutOfRange;
        }
        return decode_body(structure, sink.take(writer.written()), to);
    }
    default:
        return status::Bad_TypeMismatch;
    }
}

void clear_texts(const ImagePlace& place, std::byte* to)
{
    if (!place.is_text() && !(place.is_structure() && place.structure->has_texts())) {
        return;
    }
    for (std::uint32_t i = 0; i < place.elements; ++i, to += place.stride) {
        if (place.is_text()) {
            put_text(to, std::nullopt);
            continue;
        }
        for (const ImagePlace& member : place.structure->members()) {
            clear_texts(member, to + member.offset);
        }
    }
}

ExtensionObject borrow_object(const ImageStructure& structure, std::span<const std::byte> body)
{
    const NodeId& id = structure.encoding_id();
    NodeId borrowed;
    switch (id.id_type()) {
    case IdType::Numeric:
        borrowed = NodeId{id.namespace_index(), id.numeric()};
        break;
    case IdType::String:
        borrowed = NodeId{id.namespace_index(), String::borrow(id.string().view())};
        break;
    default:
        borrowed = id;
    }
    return ExtensionObject::from_binary(std::move(borrowed), ByteString::borrow(body));
}

} // namespace busbar::server::detail
