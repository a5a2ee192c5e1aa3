#pragma once

#include <cstddef>
#include <span>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>

namespace busbar::client {

/// The structures of namespace 0.
[[nodiscard]] BUSBAR_API const binary::TypeRegistry& standard_types();

/// Decodes the body of a response, NodeId of the encoding and the structure, as a T;
/// Bad_DecodingError if it is another type. Structures in it that `types` does not have are kept as
/// bytes.
template <typename T>
[[nodiscard]] Result<T> decode_response(std::span<const std::byte> body, binary::Strings strings,
                                        const binary::DecodeLimits& limits,
                                        const binary::TypeRegistry& types = standard_types())
{
    binary::Reader reader{body, strings, &types, limits};
    NodeId id;
    T structure;
    decode(reader, id);
    if (!id.is(T::binary_encoding_id)) {
        return fail(status::Bad_DecodingError);
    }
    decode(reader, structure);
    if (!reader.ok()) {
        return fail(reader.status());
    }
    return structure;
}

} // namespace busbar::client
