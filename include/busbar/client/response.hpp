#pragma once

#include <cstddef>
#include <span>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/core/result.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::client {

/// The body of a response, NodeId of its encoding and the structure, as a T; Bad_DecodingError if
/// it is none.
template <typename T>
[[nodiscard]] Result<T> decode_response(std::span<const std::byte> body, binary::Strings strings,
                                        const binary::DecodeLimits& limits)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
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
