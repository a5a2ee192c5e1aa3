#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/types/configuration.hpp>

#include "managed_fixture.hpp"
#include "trust_list_ids.hpp"

namespace busbar::test {

using crypto::StoreList;

/// A client's certificate that nobody trusts yet.
inline const crypto::Certificate& stranger()
{
    static const crypto::Certificate certificate = issue({}, key_number(1)).certificate;
    return certificate;
}

struct Lists : ManagedFixture {
    CallMethodResult on_list(TestClient& client, std::uint32_t method, std::vector<Variant> inputs)
    {
        return call(client, NodeId{0, trust_list}, NodeId{0, method}, std::move(inputs));
    }
    std::string_view status_of(TestClient& client, std::uint32_t method,
                               std::vector<Variant> inputs)
    {
        return name(on_list(client, method, std::move(inputs)).status_code);
    }
    std::uint32_t open(TestClient& client, std::uint8_t mode)
    {
        const auto result = on_list(client, open_method, {Variant{mode}});
        REQUIRE(result.status_code == status::Good);
        return result.output_arguments[0].value_or<std::uint32_t>(0);
    }
    TrustListDataType read_all(TestClient& client, std::uint32_t handle)
    {
        std::vector<std::byte> bytes;
        for (;;) {
            const auto piece =
                on_list(client, read_method, {Variant{handle}, Variant{std::int32_t{700}}});
            REQUIRE(piece.status_code == status::Good);
            const auto* const part = piece.output_arguments[0].get_if<ByteString>();
            if (part == nullptr || part->span().empty()) {
                break;
            }
            bytes.insert(bytes.end(), part->span().begin(), part->span().end());
        }
        TrustListDataType data;
        binary::Reader reader{bytes};
        decode(reader, data);
        REQUIRE(reader.ok());
        return data;
    }
    /// In two pieces.
    void write_all(TestClient& client, std::uint32_t handle, const TrustListDataType& data)
    {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, data);
        const auto bytes = sink.take(writer.written());
        const std::size_t half = bytes.size() / 2;
        for (const auto piece : {std::span{bytes}.first(half), std::span{bytes}.subspan(half)}) {
            CHECK(status_of(client, write_method, {Variant{handle}, Variant{ByteString{piece}}}) ==
                  "Good");
        }
    }
    /// The list of trusted certificates becomes this one; the result of CloseAndUpdate.
    std::string_view replace_trusted(TestClient& client,
                                     const std::vector<crypto::Certificate>& certificates)
    {
        TrustListDataType data;
        data.specified_lists = 1;
        for (const auto& each : certificates) {
            data.trusted_certificates.push_back(ByteString{each.der()});
        }
        const auto handle = open(client, writing);
        write_all(client, handle, data);
        return status_of(client, close_and_update, {Variant{handle}});
    }
    std::string_view apply(TestClient& client)
    {
        return name(call(client, NodeId{0, id::ServerConfiguration},
                         NodeId{0, id::ServerConfiguration_ApplyChanges}, {})
                        .status_code);
    }
    std::string_view cancel(TestClient& client)
    {
        return name(call(client, NodeId{0, id::ServerConfiguration},
                         NodeId{0, id::ServerConfiguration_CancelChanges}, {})
                        .status_code);
    }
};

inline const crypto::Certificate& own_client()
{
    return client_identity().certificates.front();
}

} // namespace busbar::test
