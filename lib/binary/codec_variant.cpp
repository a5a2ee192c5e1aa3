#include <busbar/binary/codec.hpp>

#include <array>
#include <cstdint>
#include <type_traits>

#include "wire_masks.hpp"

namespace busbar {

namespace {

namespace mask = detail::variant_mask;

struct VariantCodec {
    void (*encode_scalar)(binary::Writer& writer, const Variant& value);
    void (*encode_array)(binary::Writer& writer, const Variant& value);
    void (*decode_scalar)(binary::Reader& reader, Variant& value);
    void (*decode_array)(binary::Reader& reader, Variant& value, bool has_dimensions);
};

/// True if `dimensions` has two or more, none is 0 and `count` elements fill them.
bool is_matrix_of(std::span<const std::uint32_t> dimensions, std::size_t count)
{
    std::size_t product = 1;
    for (const std::uint32_t dimension : dimensions) {
        if (dimension == 0 || product > count / dimension) {
            return false;
        }
        product *= dimension;
    }
    return product == count;
}

/// Reads the dimensions after an array of `count` elements. None for a vector or an empty array.
Array<std::uint32_t> decode_dimensions(binary::Reader& reader, std::size_t count)
{
    Array<std::uint32_t> dimensions;
    decode(reader, dimensions);
    bool is_empty = false;
    for (const std::uint32_t dimension : dimensions) {
        is_empty = is_empty || dimension == 0;
        if (dimension > INT32_MAX) {
            reader.fail(status::Bad_DecodingError);
        }
    }
    // Part 6, 5.2.2.16: the product of the dimensions is the length of the array.
    if (dimensions.empty() || (is_empty && count == 0)) {
        return {};
    }
    if (is_empty || !is_matrix_of(dimensions.span(), count)) {
        reader.fail(status::Bad_DecodingError);
    }
    return dimensions;
}

template <typename T>
struct CodecOf {
    static void encode_scalar(binary::Writer& writer, const Variant& value)
    {
        if constexpr (!std::is_same_v<T, Variant>) {
            encode(writer, *value.get_if<T>());
        }
    }
    static void encode_array(binary::Writer& writer, const Variant& value)
    {
        encode(writer, *value.array_if<T>());
    }
    static void decode_scalar(binary::Reader& reader, Variant& value)
    {
        if constexpr (std::is_same_v<T, Variant>) {
            reader.fail(status::Bad_DecodingError); // Part 6, 5.2.2.16: only in arrays
        } else {
            if (sizeof(T) > sizeof(Variant) && !reader.charge(sizeof(T))) {
                return;
            }
            T scalar{};
            decode(reader, scalar);
            value = Variant{std::move(scalar)};
        }
    }
    static void decode_array(binary::Reader& reader, Variant& value, bool has_dimensions)
    {
        Array<T> elements;
        decode(reader, elements);
        if (!has_dimensions) {
            value = Variant{std::move(elements)};
            return;
        }
        auto dimensions = decode_dimensions(reader, elements.size());
        if (reader.ok()) {
            value = Variant::matrix(std::move(elements), std::move(dimensions));
        }
    }
    static constexpr VariantCodec table{encode_scalar, encode_array, decode_scalar, decode_array};
};

const VariantCodec& codec_of(BuiltInType type)
{
    // In the order of the built-in type ids, from Boolean on.
    static constexpr std::array<const VariantCodec*, last_built_in_type> tables = {
        &CodecOf<bool>::table,          &CodecOf<std::int8_t>::table,
        &CodecOf<std::uint8_t>::table,  &CodecOf<std::int16_t>::table,
        &CodecOf<std::uint16_t>::table, &CodecOf<std::int32_t>::table,
        &CodecOf<std::uint32_t>::table, &CodecOf<std::int64_t>::table,
        &CodecOf<std::uint64_t>::table, &CodecOf<float>::table,
        &CodecOf<double>::table,        &CodecOf<String>::table,
        &CodecOf<DateTime>::table,      &CodecOf<Guid>::table,
        &CodecOf<ByteString>::table,    &CodecOf<XmlElement>::table,
        &CodecOf<NodeId>::table,        &CodecOf<ExpandedNodeId>::table,
        &CodecOf<StatusCode>::table,    &CodecOf<QualifiedName>::table,
        &CodecOf<LocalizedText>::table, &CodecOf<ExtensionObject>::table,
        &CodecOf<DataValue>::table,     &CodecOf<Variant>::table,
        &CodecOf<DiagnosticInfo>::table};
    return *tables[static_cast<std::size_t>(type) - 1];
}

void encode_array(binary::Writer& writer, const Variant& value)
{
    const auto dimensions = value.dimensions();
    const bool is_matrix = is_matrix_of(dimensions, value.array_size()) && dimensions.size() > 1;
    const unsigned flags = mask::array | (is_matrix ? mask::dimensions : 0U);
    writer.number(static_cast<std::uint8_t>(static_cast<unsigned>(value.type()) | flags));
    codec_of(value.type()).encode_array(writer, value);
    if (is_matrix) {
        writer.length(dimensions.size());
        writer.numbers(dimensions);
    }
}

void decode_value(binary::Reader& reader, unsigned bits, Variant& value)
{
    const bool is_array = (bits & mask::array) != 0;
    const bool has_dimensions = (bits & mask::dimensions) != 0;
    if (!mask::is_valid(bits)) {
        reader.fail(status::Bad_DecodingError);
        return;
    }
    const BuiltInType type = mask::type_of(bits);
    if (!reader.enter()) {
        return;
    }
    if (is_array) {
        codec_of(type).decode_array(reader, value, has_dimensions);
    } else {
        codec_of(type).decode_scalar(reader, value);
    }
    reader.leave();
}

} // namespace

void encode(binary::Writer& writer, const Variant& value)
{
    if (value.is_null()) {
        writer.number(std::uint8_t{0});
        return;
    }
    if (!writer.enter()) {
        return;
    }
    if (value.is_array()) {
        encode_array(writer, value);
    } else {
        writer.number(value.type());
        codec_of(value.type()).encode_scalar(writer, value);
    }
    writer.leave();
}

void decode(binary::Reader& reader, Variant& value)
{
    const unsigned bits = reader.number<std::uint8_t>();
    value = Variant{};
    if (bits != 0) {
        decode_value(reader, bits, value);
    }
}

} // namespace busbar
