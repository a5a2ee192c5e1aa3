#include <catch2/catch.hpp>

#include <busbar/types/attribute.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/ids.hpp>

#include "support/allocation_count.hpp"
#include "support/server_fixture.hpp"

namespace decode_bomb_test {

using namespace busbar;
using namespace busbar::test;

namespace {

using Bytes = std::vector<std::byte>;

/// A Variant on the wire: an array of arrays of DiagnosticInfo, each of one byte and of some
/// hundred as an object.
Bytes bomb(std::size_t size)
{
    constexpr std::size_t in_one = 8'000;
    binary::VectorSink sink;
    binary::Writer writer{sink};
    const std::size_t arrays = size / in_one;
    writer.number(std::uint8_t{0x80 | 24}); // array of Variant
    writer.length(arrays);
    for (std::size_t i = 0; i < arrays; ++i) {
        writer.number(std::uint8_t{0x80 | 25}); // array of DiagnosticInfo
        writer.length(in_one);
        writer.bytes(Bytes(in_one));
    }
    return sink.take(writer.written());
}

/// GetEndpoints with something behind the header's other fields.
std::uint32_t ask_with(TestClient& client, std::uint32_t encoding_id, const Bytes& body)
{
    GetEndpointsRequest request;
    request.endpoint_url = "opc.tcp://localhost:4840";
    request.request_header.additional_header =
        ExtensionObject::from_binary(NodeId{0, encoding_id}, ByteString{body});
    return client.send(std::move(request));
}

/// The bytes of an AdditionalParametersType with one parameter.
Bytes parameters(const Bytes& value)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    writer.length(1);
    encode(writer, QualifiedName{0, "a"});
    writer.bytes(value);
    return sink.take(writer.written());
}

} // namespace

TEST_CASE("what stands in an additionalHeader is read over and never built")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    const Bytes body = parameters(bomb(40'000));
    const auto taken_by = [&](std::uint32_t encoding_id) {
        const std::size_t before = allocated_bytes();
        const auto response =
            client.take<GetEndpointsResponse>(ask_with(client, encoding_id, body));
        REQUIRE(response);
        CHECK_FALSE(response->endpoints.empty());
        return allocated_bytes() - before;
    };
    const std::size_t first = taken_by(99'999);
    const std::size_t unknown = taken_by(99'999);
    CHECK(unknown <= first);
    CHECK(taken_by(AdditionalParametersType::binary_encoding_id) <= unknown + 1'000);
}

TEST_CASE("an additionalHeader that is none is no request")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    const auto request = client.send_bytes([&](binary::Writer& writer) {
        RequestHeader header;
        header.additional_header =
            ExtensionObject::from_binary(NodeId{0, 99'999}, ByteString{Bytes(4)});
        binary::VectorSink sink;
        binary::Writer inner{sink};
        encode(inner, header);
        Bytes bytes = sink.take(inner.written());
        bytes[bytes.size() - 8] = std::byte{255}; // of the body's length
        encode(writer, NodeId{0, GetEndpointsRequest::binary_encoding_id});
        writer.bytes(bytes);
    });
    CHECK(client.take<GetEndpointsResponse>(request).error() == status::Bad_DecodingError);
}

TEST_CASE("who has no session sends no large message")
{
    ServerFixture fixture;
    const std::size_t most = server::ServerLimits{}.max_sessionless_message;
    auto client = fixture.connect();
    REQUIRE(client.take<GetEndpointsResponse>(ask_with(client, 99'999, Bytes(most - 1'000))));
    SECTION("before")
    {
        ask_with(client, 99'999, Bytes(most + 1'000));
        CHECK(client.is_closed());
    }
    SECTION("created is not activated")
    {
        REQUIRE(client.create_session(client.create_request()));
        ask_with(client, 99'999, Bytes(most + 1'000));
        CHECK(client.is_closed());
    }
    SECTION("while there is a session")
    {
        REQUIRE(client.create_session(client.create_request()));
        REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
        CHECK(client.take<GetEndpointsResponse>(ask_with(client, 99'999, Bytes(most + 1'000))));
        REQUIRE(client.status_of<CloseSessionResponse>(CloseSessionRequest{}) == status::Good);
        ask_with(client, 99'999, Bytes(most + 1'000));
        CHECK(client.is_closed());
    }
}

TEST_CASE("what a message becomes is bounded by its size")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    const Bytes value = bomb(400'000);
    const std::size_t before = allocated_bytes();
    const auto request = client.send_bytes([&](binary::Writer& writer) {
        WriteRequest write;
        write.request_header.authentication_token = client.authentication_token;
        encode(writer, NodeId{0, WriteRequest::binary_encoding_id});
        encode(writer, write.request_header);
        writer.length(1);
        encode(writer, NodeId{0, id::Server_ServerStatus_State});
        writer.number(std::uint32_t{13});
        encode(writer, String{});
        writer.number(std::uint8_t{1}); // a DataValue with a value
        writer.bytes(value);
    });
    CHECK(client.take<WriteResponse>(request).error() == status::Bad_EncodingLimitsExceeded);
    // The message itself is held some times on both sides, as chunks and put together.
    CHECK(allocated_bytes() - before < 20 * value.size());
}

} // namespace decode_bomb_test
