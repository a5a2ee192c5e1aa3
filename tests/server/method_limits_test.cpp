#include <catch2/catch.hpp>

#include "method_fixture.hpp"

namespace method_limits_test {

using namespace busbar;
using namespace busbar::test;
using busbar::server::MethodCall;

namespace {

struct Fixture : MethodFixture {
    using MethodFixture::MethodFixture;

    /// What a Call answers whose input arguments are these bytes.
    static StatusCode status_of_bytes(TestClient& client, const NodeId& method,
                                      FunctionRef<void(binary::Writer&)> write_inputs)
    {
        const auto id = client.send_bytes([&](binary::Writer& writer) {
            RequestHeader header;
            header.authentication_token = client.authentication_token;
            encode(writer, NodeId{0, CallRequest::binary_encoding_id});
            encode(writer, header);
            writer.length(1);
            encode(writer, own("Machine"));
            encode(writer, method);
            write_inputs(writer);
        });
        const auto response = client.take<CallResponse>(id);
        return response ? status::Good : response.error();
    }
};

} // namespace

TEST_CASE("a Call is checked before its Methods are looked at")
{
    auto config = Fixture::insecure_config();
    config.limits.operations.max_nodes_per_method_call = 2;
    Fixture fixture{std::move(config)};
    const NodeId sum = fixture.add_sum();
    auto client = fixture.log_in();
    CHECK(client.status_of<CallResponse>(Fixture::request({})) == status::Bad_NothingToDo);
    const CallMethodRequest one = Fixture::to_call(sum, {Variant{1}, Variant{2}});
    CHECK(client.status_of<CallResponse>(Fixture::request({one, one, one})) ==
          status::Bad_TooManyOperations);
    const auto both = client.call<CallResponse>(
        Fixture::request({one, Fixture::to_call(Fixture::own("Nothing"))}));
    REQUIRE(both);
    REQUIRE(both->results.size() == 2);
    CHECK(both->results[0].output_arguments[0] == Variant{3});
    CHECK(both->results[1].status_code == status::Bad_NodeIdUnknown);
    CHECK(Fixture::read(
              client,
              NodeId{0, id::Server_ServerCapabilities_OperationLimits_MaxNodesPerMethodCall},
              AttributeId::Value) == Variant{std::uint32_t{2}});
}

TEST_CASE_METHOD(Fixture, "a hostile Call is refused early")
{
    const NodeId sum = add_sum();
    auto client = log_in();
    SECTION("more arguments than any Method has")
    {
        // Null values of one byte each would be refused for the memory that they become.
        Array<Variant> many(25'000);
        std::fill(many.begin(), many.end(), Variant{1});
        CHECK(status_of(client, to_call(sum, many)) == status::Bad_TooManyArguments);
    }
    SECTION("more arguments than there are bytes")
    {
        CHECK(status_of_bytes(client, sum, [](binary::Writer& writer) {
                  writer.number(std::int32_t{0x7FFFFFFF});
              }) == status::Bad_EncodingLimitsExceeded);
    }
    SECTION("values in values, past any depth")
    {
        // An array of one Variant, which is an array of one Variant, and so on.
        constexpr std::uint8_t array_of_variant = 0x98;
        CHECK(status_of_bytes(client, sum, [](binary::Writer& writer) {
                  for (int i = 0; i < 10'000; ++i) {
                      writer.length(1);
                      writer.number(array_of_variant);
                  }
                  writer.length(0);
              }) == status::Bad_EncodingLimitsExceeded);
    }
    CHECK(status_of(client, to_call(sum, {Variant{1}, Variant{2}})) == status::Good);
}

TEST_CASE_METHOD(Fixture, "an answer that the client cannot take is a fault")
{
    const NodeId big = add("Big", {}, {argument(id::Byte, 1)}, [](MethodCall call) {
        call.succeed({Variant{Array<std::uint8_t>(100'000)}});
    });
    auto client = connect();
    auto create = client.create_request();
    create.max_response_message_size = 50'000;
    REQUIRE(client.create_session(create));
    REQUIRE(client.activate(client.anonymous()) == status::Good);
    CHECK(client.status_of<CallResponse>(request({to_call(big)})) == status::Bad_ResponseTooLarge);
}

TEST_CASE("what a Call makes the server hold is charged to its session")
{
    auto config = MethodFixture::insecure_config();
    config.limits.max_session_memory = 20'000;
    MethodFixture fixture{std::move(config)};
    const NodeId slow = fixture.add_slow("Slow");
    auto client = fixture.log_in();
    const CallRequest one = MethodFixture::request({MethodFixture::to_call(slow, {Variant{1}})});
    CallRequest many;
    many.methods_to_call = Array<CallMethodRequest>(200); // small where pointers are
    CHECK(client.status_of<CallResponse>(many) == status::Bad_TooManyOperations);
    const auto first = client.send(one);
    fixture.calls.front().succeed({Variant{2}});
    fixture.server.handle_completions(fixture.now);
    REQUIRE(client.take<CallResponse>(first));
    for (int i = 0; i < 100; ++i) {
        const auto id = client.send(one); // nothing is left behind
        fixture.calls.back().succeed({Variant{2}});
        fixture.server.handle_completions(fixture.now);
        REQUIRE(client.take<CallResponse>(id));
    }
}

} // namespace method_limits_test
