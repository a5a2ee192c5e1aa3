#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/registry.hpp>

namespace busbar::test {

/// The response in a message's body: the status of a ServiceFault, Bad_UnknownResponse for any
/// other structure, Bad_DecodingError for what is none. `handle`, if not null, gets the header's.
template <typename Response>
[[nodiscard]] Result<Response> decode_response(std::span<const std::byte> body,
                                               std::uint32_t* handle = nullptr)
{
    static const binary::TypeRegistry types{binary::namespace0_types()};
    binary::Reader reader{body, binary::Strings::Own, &types};
    const auto keep = [&](const ResponseHeader& header) {
        if (handle != nullptr) {
            *handle = header.request_handle;
        }
    };
    NodeId id;
    decode(reader, id);
    if (id.is(ServiceFault::binary_encoding_id)) {
        ServiceFault fault;
        decode(reader, fault);
        keep(fault.response_header);
        return fail(fault.response_header.service_result);
    }
    if (!id.is(Response::binary_encoding_id)) {
        return fail(status::Bad_UnknownResponse);
    }
    Response response;
    decode(reader, response);
    keep(response.response_header);
    if (!reader.ok() || reader.remaining() != 0) {
        return fail(status::Bad_DecodingError);
    }
    return response;
}

} // namespace busbar::test
