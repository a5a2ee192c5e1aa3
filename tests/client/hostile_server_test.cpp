#include <catch2/catch.hpp>

#include <busbar/types/method.hpp>

#include "rogue_fixture.hpp"

namespace hostile_server_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

TEST_CASE("an honest server is not suspected")
{
    RogueFixture fixture{GENERATE(false, true)};
    fixture.connect();
    INFO(fixture.log.text);
    CHECK(fixture.is_ready());
    fixture.read();
    CHECK(fixture.results == std::vector<StatusCode>{status::Good});
}

TEST_CASE("any answer of another kind ends the attempt, and the next one comes later each time")
{
    RogueFixture fixture;
    const auto request =
        GENERATE(GetEndpointsRequest::binary_encoding_id, CreateSessionRequest::binary_encoding_id,
                 ActivateSessionRequest::binary_encoding_id, ReadRequest::binary_encoding_id);
    const auto answer = GENERATE(body_of(CallResponse{}), std::vector<std::byte>{std::byte{9}},
                                 fault(status::Bad_TooManySessions), fault(status::Good),
                                 fault(status::Bad_InvalidTimestamp));
    fixture.answers.raw = [&](const NodeId& id) {
        return id.is(request) ? std::optional{answer} : std::nullopt;
    };
    fixture.connect();
    CHECK(fixture.client.state() == ClientState::Waiting);
    CHECK(fixture.client.last_error().is_bad());
    std::vector<Duration> waits;
    for (int i = 0; i < 8; ++i) {
        waits.push_back(fixture.client.next_deadline() - fixture.now);
        fixture.advance(waits.back());
    }
    CHECK(waits.front() >= 800ms);
    CHECK(waits.front() <= 1s);
    CHECK(waits.back() >= 24s);
    CHECK(waits.back() <= 30s);
    CHECK(fixture.connections <= 2 * 9);
}

TEST_CASE("a server that does not answer is given up after the time for an attempt")
{
    RogueFixture fixture;
    const auto request =
        GENERATE(GetEndpointsRequest::binary_encoding_id, CreateSessionRequest::binary_encoding_id,
                 ActivateSessionRequest::binary_encoding_id, ReadRequest::binary_encoding_id);
    fixture.answers.raw = [&](const NodeId& id) {
        return id.is(request) ? std::optional{std::vector<std::byte>{}} : std::nullopt;
    };
    fixture.connect();
    CHECK(fixture.client.next_deadline() <= fixture.now + 20s);
    fixture.advance(10s);
    fixture.advance(10s);
    CHECK(fixture.client.last_error() == status::Bad_Timeout);
}

TEST_CASE("what a server says about itself is bounded, and may be missing")
{
    RogueFixture fixture;
    std::vector<std::string> expected{"http://opcfoundation.org/UA/"};
    int too_many = 0;
    SECTION("nothing is there")
    {
        fixture.answers.read = [](const ReadRequest&, ReadResponse& response) {
            for (DataValue& value : response.results) {
                value.status = status::Bad_NodeIdUnknown;
            }
        };
    }
    SECTION("values of other types")
    {
        fixture.answers.read = [](const ReadRequest&, ReadResponse& response) {
            for (DataValue& value : response.results) {
                value.value = Variant{3.5};
            }
        };
    }
    SECTION("no service")
    {
        fixture.answers.raw = [](const NodeId& id) {
            return id.is(ReadRequest::binary_encoding_id)
                       ? std::optional{fault(status::Bad_ServiceUnsupported)}
                       : std::nullopt;
        };
        expected.clear();
    }
    SECTION("one node at a time")
    {
        fixture.answers.read = [&](const ReadRequest& request, ReadResponse& response) {
            if (request.nodes_to_read.size() > 1) {
                response.response_header.service_result = status::Bad_TooManyOperations;
                response.results = {};
                ++too_many;
            }
        };
    }
    SECTION("more than anybody needs")
    {
        fixture.answers.read = [](const ReadRequest&, ReadResponse& response) {
            response.results[0].value = Variant{Array<String>(60'000)};
        };
        expected.assign(10'000, "");
    }
    fixture.connect();
    INFO(fixture.log.text);
    CHECK(fixture.is_ready());
    CHECK(fixture.client.server().namespaces == expected);
    CHECK(fixture.client.server().operation_limits == client::ServerOperationLimits{});
    CHECK(too_many <= 1);
}

TEST_CASE("results that were not asked for are no answer")
{
    RogueFixture fixture;
    const std::size_t count = GENERATE(0U, 9U, 11U, 5'000U);
    fixture.answers.read = [&](const ReadRequest&, ReadResponse& response) {
        response.results.resize(count);
    };
    fixture.connect();
    CHECK(fixture.client.last_error() == status::Bad_UnknownResponse);
}

TEST_CASE("a list of endpoints without end is not looked through")
{
    RogueFixture fixture;
    fixture.answers.endpoints = [](GetEndpointsResponse& response) {
        const EndpointDescription one = response.endpoints[0];
        response.endpoints.resize(501);
        std::ranges::fill(response.endpoints, one);
    };
    fixture.connect();
    CHECK(fixture.client.last_error() == status::Bad_ResponseTooLarge);
}

TEST_CASE("answers that nobody asked for, or that come twice, are dropped")
{
    RogueFixture fixture;
    fixture.connect();
    REQUIRE(fixture.is_ready());
    fixture.server->send(4'711, body_of(ReadResponse{}));
    fixture.run();
    fixture.read();
    fixture.server->send(fixture.server->answered.back(), body_of(ReadResponse{}));
    fixture.run();
    CHECK(fixture.results.size() == 1);
    CHECK(fixture.is_ready());
}

} // namespace hostile_server_test
