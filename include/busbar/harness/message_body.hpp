#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/core/result.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::harness {

/// Returns the structure in a message's body: the NodeId of its encoding and its fields.
/// Bad_DecodingError for another structure.
template <typename Structure>
[[nodiscard]] Result<Structure> decode_body(std::span<const std::byte> body)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    binary::Reader reader{body, binary::Strings::Own, &types};
    NodeId id;
    Structure structure;
    decode(reader, id);
    decode(reader, structure);
    if (!id.is(Structure::binary_encoding_id) || !reader.ok()) {
        return fail(status::Bad_DecodingError);
    }
    return structure;
}

/// Returns the body of a message with this structure.
template <typename Structure>
[[nodiscard]] Result<std::vector<std::byte>> encode_body(const Structure& structure)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, NodeId{0, Structure::binary_encoding_id});
    encode(writer, structure);
    if (!writer.ok()) {
        return fail(writer.status());
    }
    return sink.take(writer.written());
}

} // namespace busbar::harness
