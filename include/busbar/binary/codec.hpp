#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/types.hpp>

/// OPC UA Binary encoding of the built-in types (Part 6, 5.2). `encode` and `decode` are overloads
/// in namespace busbar so that generated structures join them; errors stay in the Writer or Reader.
namespace busbar {

namespace detail {

/// The minimum size of a T on the wire, which array_length checks a count against.
template <typename T>
constexpr std::size_t min_wire_size()
{
    if constexpr (WireNumber<T>) {
        return sizeof(T);
    } else if constexpr (requires { T::min_wire_size; }) {
        return T::min_wire_size;
    } else if constexpr (std::is_same_v<T, DateTime>) {
        return 8;
    } else if constexpr (std::is_same_v<T, Guid>) {
        return 16;
    } else if constexpr (std::is_base_of_v<Blob, T> || std::is_same_v<T, StatusCode>) {
        return 4;
    } else if constexpr (std::is_same_v<T, QualifiedName>) {
        return 6;
    } else if constexpr (std::is_same_v<T, NodeId> || std::is_same_v<T, ExpandedNodeId>) {
        return 2;
    } else if constexpr (std::is_same_v<T, ExtensionObject>) {
        return 3;
    } else {
        return 1;
    }
}

} // namespace detail

/// Writes a value of a built-in type (Part 6, 5.2.2).
template <detail::WireNumber T>
void encode(binary::Writer& writer, T value)
{
    writer.number(value);
}
inline void encode(binary::Writer& writer, bool value)
{
    writer.number(static_cast<std::uint8_t>(value ? 1 : 0));
}
/// Any NaN is encoded as the one quiet NaN of Part 6, 5.2.2.3.
BUSBAR_API void encode(binary::Writer& writer, float value);
BUSBAR_API void encode(binary::Writer& writer, double value);
/// Writes a value of a built-in type (Part 6, 5.2.2).
BUSBAR_API void encode(binary::Writer& writer, const String& value);
BUSBAR_API void encode(binary::Writer& writer, const XmlElement& value);
BUSBAR_API void encode(binary::Writer& writer, const ByteString& value);
BUSBAR_API void encode(binary::Writer& writer, DateTime value);
BUSBAR_API void encode(binary::Writer& writer, const Guid& value);
BUSBAR_API void encode(binary::Writer& writer, const NodeId& value);
BUSBAR_API void encode(binary::Writer& writer, const ExpandedNodeId& value);
BUSBAR_API void encode(binary::Writer& writer, StatusCode value);
BUSBAR_API void encode(binary::Writer& writer, const QualifiedName& value);
BUSBAR_API void encode(binary::Writer& writer, const LocalizedText& value);
BUSBAR_API void encode(binary::Writer& writer, const ExtensionObject& value);
BUSBAR_API void encode(binary::Writer& writer, const DataValue& value);
BUSBAR_API void encode(binary::Writer& writer, const Variant& value);
BUSBAR_API void encode(binary::Writer& writer, const DiagnosticInfo& value);

/// Reads a value of a built-in type (Part 6, 5.2.2); after the end the reader fails, see Reader.
template <detail::WireNumber T>
void decode(binary::Reader& reader, T& value)
{
    value = reader.number<T>();
}
/// Any byte but 0 is true (Part 6, 5.2.2.1).
inline void decode(binary::Reader& reader, bool& value)
{
    value = reader.number<std::uint8_t>() != 0;
}
BUSBAR_API void decode(binary::Reader& reader, String& value);
BUSBAR_API void decode(binary::Reader& reader, XmlElement& value);
BUSBAR_API void decode(binary::Reader& reader, ByteString& value);
BUSBAR_API void decode(binary::Reader& reader, DateTime& value);
BUSBAR_API void decode(binary::Reader& reader, Guid& value);
BUSBAR_API void decode(binary::Reader& reader, NodeId& value);
BUSBAR_API void decode(binary::Reader& reader, ExpandedNodeId& value);
BUSBAR_API void decode(binary::Reader& reader, StatusCode& value);
BUSBAR_API void decode(binary::Reader& reader, QualifiedName& value);
BUSBAR_API void decode(binary::Reader& reader, LocalizedText& value);
BUSBAR_API void decode(binary::Reader& reader, ExtensionObject& value);
/// Skips an ExtensionObject without looking into its body.
BUSBAR_API void skip_extension_object(binary::Reader& reader);
BUSBAR_API void decode(binary::Reader& reader, DataValue& value);
BUSBAR_API void decode(binary::Reader& reader, Variant& value);
BUSBAR_API void decode(binary::Reader& reader, DiagnosticInfo& value);

namespace detail {
/// Writes the elements as they are, but each NaN as that of Part 6, 5.2.2.3.
BUSBAR_API void encode_reals(binary::Writer& writer, std::span<const float> values);
BUSBAR_API void encode_reals(binary::Writer& writer, std::span<const double> values);
} // namespace detail

/// Arrays (Part 6, 5.2.5): an Int32 count, -1 for null, and the elements.
template <typename T>
void encode(binary::Writer& writer, const Array<T>& values)
{
    if (values.is_null()) {
        writer.number(std::int32_t{-1});
        return;
    }
    writer.length(values.size());
    if constexpr (std::is_floating_point_v<T>) {
        detail::encode_reals(writer, values.span());
    } else if constexpr (detail::WireNumber<T>) {
        writer.numbers(values.span());
    } else {
        for (const T& value : values) {
            encode(writer, value);
        }
    }
}
template <typename T>
void decode(binary::Reader& reader, Array<T>& values)
{
    const std::int32_t count = reader.array_length(detail::min_wire_size<T>(), sizeof(T));
    values.reset();
    if (count < 0 || !reader.ok()) {
        return;
    }
    values.reserve(static_cast<std::size_t>(count), reader.kept_memory());
    values.resize(static_cast<std::size_t>(count));
    if constexpr (detail::WireNumber<T>) {
        reader.numbers(values.span());
    } else {
        for (T& value : values) {
            decode(reader, value);
        }
    }
}

namespace binary {

/// Returns the encoding of `value` alone, or the reason why it cannot be encoded.
template <typename T>
[[nodiscard]] Result<std::vector<std::byte>> to_bytes(const T& value)
{
    VectorSink sink;
    Writer writer{sink};
    encode(writer, value);
    if (!writer.ok()) {
        return busbar::fail(writer.status());
    }
    return sink.take(writer.written());
}

/// Returns the number of bytes that `values` take on the wire, one after the other.
template <typename... T>
[[nodiscard]] std::size_t encoded_size(const T&... values)
{
    CountingSink sink;
    Writer writer{sink};
    (encode(writer, values), ...);
    return writer.written();
}

/// Decodes a T from all of `bytes`; Bad_DecodingError if bytes are left over.
template <typename T>
[[nodiscard]] Result<T> from_bytes(std::span<const std::byte> bytes,
                                   const TypeRegistry* types = nullptr,
                                   const DecodeLimits& limits = {})
{
    Reader reader{bytes, Strings::Own, types, limits};
    T value{};
    decode(reader, value);
    if (reader.ok() && reader.remaining() != 0) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.ok()) {
        return busbar::fail(reader.status());
    }
    return value;
}

/// Returns the structure of namespace 0 in an ExtensionObject, decoded already or still encoded as
/// in files and generated nodes; nothing for any other.
template <typename T>
[[nodiscard]] std::optional<T> structure_of(const ExtensionObject& object)
{
    if (const T* const value = object.get_if<T>()) {
        return *value;
    }
    if (object.body() == ExtensionObject::Body::Binary &&
        object.encoding_id().is(T::binary_encoding_id)) {
        if (auto decoded = from_bytes<T>(object.binary().span())) {
            return *std::move(decoded);
        }
    }
    return std::nullopt;
}
/// The same for a value that is one structure.
template <typename T>
[[nodiscard]] std::optional<T> structure_of(const Variant& value)
{
    const auto* const object = value.get_if<ExtensionObject>();
    return object != nullptr ? structure_of<T>(*object) : std::nullopt;
}

} // namespace binary

} // namespace busbar
