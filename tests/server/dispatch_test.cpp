#include <catch2/catch.hpp>

#include <busbar/types/node_management.hpp>
#include <busbar/types/view.hpp>

#include "support/slow_server.hpp"

namespace dispatch_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// A request of any type with an empty body behind its header.
std::uint32_t send_type(TestClient& client, std::uint32_t encoding_id, bool with_header = true)
{
    return client.send_bytes([&](binary::Writer& writer) {
        encode(writer, NodeId{0, encoding_id});
        if (with_header) {
            RequestHeader header;
            header.authentication_token = client.authentication_token;
            header.request_handle = 77;
            encode(writer, header);
        }
    });
}

} // namespace

TEST_CASE("the handle of a request comes back, in faults too",
          "[unit:Session General Service Behaviour]")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
    CHECK(client.handle_of_answer == client.last_handle);
    CHECK(client.status_of<ReadResponse>(ReadRequest{}) == status::Bad_NothingToDo);
    CHECK(client.handle_of_answer == client.last_handle);
}

TEST_CASE("services that are not there answer Bad_ServiceUnsupported")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    CHECK(client.status_of<DeleteNodesResponse>(DeleteNodesRequest{}) ==
          status::Bad_ServiceUnsupported);
    CHECK(client.status_of<AddNodesResponse>(AddNodesRequest{}) == status::Bad_ServiceUnsupported);
    for (const std::uint32_t type : {99'999U, ReadValueId::binary_encoding_id}) {
        const auto request = send_type(client, type);
        CHECK(answer(client, request) == status::Bad_ServiceUnsupported);
        CHECK(client.handle_of_answer == 77);
    }
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("what cannot be decoded answers Bad_DecodingError and harms nobody")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    SECTION("truncated request")
    {
        for (const std::uint32_t type :
             {ReadRequest::binary_encoding_id, BrowseRequest::binary_encoding_id}) {
            CHECK(answer(client, send_type(client, type)) == status::Bad_DecodingError);
            CHECK(client.handle_of_answer == 77);
        }
    }
    SECTION("no header")
    {
        CHECK(answer(client, send_type(client, ReadRequest::binary_encoding_id, false)) ==
              status::Bad_DecodingError);
    }
    SECTION("nothing at all")
    {
        const auto request = client.send_bytes([](binary::Writer&) {});
        CHECK(answer(client, request) == status::Bad_DecodingError);
    }
    SECTION("bytes left over")
    {
        const auto request = client.send_bytes([&](binary::Writer& writer) {
            ReadRequest read = SlowFixture::fast();
            read.request_header.authentication_token = client.authentication_token;
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, read);
            writer.number(std::uint8_t{0});
        });
        CHECK(answer(client, request) == status::Bad_DecodingError);
    }
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("a client that sends responses does not speak the protocol")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    send_type(client, ReadResponse::binary_encoding_id);
    CHECK(client.is_closed());
}

TEST_CASE("a response that is larger than the client wants is a fault")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    auto request = client.create_request();
    request.max_response_message_size = 600;
    REQUIRE(client.create_session(request));
    REQUIRE(client.activate(TestClient::anonymous()) == status::Good);
    const NodeId state{0, id::Server_ServerStatus_State};
    CHECK(client.status_of<ReadResponse>(SlowFixture::read(state, 10)) == status::Good);
    CHECK(client.status_of<ReadResponse>(SlowFixture::read(state, 100)) ==
          status::Bad_ResponseTooLarge);
    CHECK(client.status_of<ReadResponse>(SlowFixture::read(state, 10)) == status::Good);
}

} // namespace dispatch_test
