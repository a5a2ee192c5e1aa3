#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/report.hpp>
#include <busbar/harness/scripted_client.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

namespace scripted_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

constexpr const char* url = "opc.tcp://server:4840";

ReadRequest read_request(const NodeId& node)
{
    ReadRequest request;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = node;
    item.attribute_id = 13;
    return request;
}

ReadResponse read_response(Variant value)
{
    ReadResponse response;
    response.results.push_back(DataValue{std::move(value)});
    return response;
}

/// A client and the server that a test writes for it.
struct Script {
    World world;
    ScriptedServer server{world, url};
    ConnectionHost client{world};
};

channel::ClientChannelConfig channel_config()
{
    channel::ClientChannelConfig config;
    config.endpoint_url = url;
    return config;
}

} // namespace

TEST_CASE("a scripted server says what was written down, when it was", "[harness]")
{
    Script script;
    script.server.accept_session();
    script.server.expect<ReadRequest>().reply(read_response(std::int32_t{7}), after(400ms));
    script.server.expect<ReadRequest>().reply([](const ReadRequest& request) {
        return read_response(String{to_string(request.nodes_to_read[0].node_id)});
    });
    script.server.expect<WriteRequest>().fail(status::Bad_TooManyOperations);
    REQUIRE(script.client.open());
    const TimePoint before = script.world.now();
    const auto first = script.client.call<ReadResponse>(read_request(NodeId{1, 5U}));
    REQUIRE(first);
    CHECK_THAT(first->results[0], holds(7));
    CHECK(script.world.now() - before == 402ms);
    const auto second = script.client.call<ReadResponse>(read_request(NodeId{1, 5U}));
    REQUIRE(second);
    CHECK_THAT(second->results[0], holds(String{"ns=1;i=5"}));
    CHECK(script.client.call<WriteResponse>(WriteRequest{}).error() ==
          status::Bad_TooManyOperations);
    CHECK(script.server.is_done());
    CHECK(script.server.report() == "");
}

TEST_CASE("a client learns when a scripted server is silent, closes or goes", "[harness]")
{
    Script script;
    script.server.accept_session();
    SECTION("silent")
    {
        script.server.expect<ReadRequest>();
        REQUIRE(script.client.open());
        CHECK(script.client.call<ReadResponse>(read_request({})).error() == status::Bad_Timeout);
        CHECK(script.client.is_ready());
    }
    SECTION("closes")
    {
        script.server.expect<ReadRequest>().close(status::Bad_TcpInternalError, after(1s));
        REQUIRE(script.client.open());
        CHECK_FALSE(script.client.call<ReadResponse>(read_request({})));
        CHECK(script.client.closed_by() == status::Bad_TcpInternalError);
    }
    SECTION("goes")
    {
        script.server.expect<ReadRequest>().cut();
        REQUIRE(script.client.open());
        CHECK(script.client.call<ReadResponse>(read_request({})).error() ==
              status::Bad_ConnectionClosed);
    }
    CHECK(script.server.report() == "");
}

TEST_CASE("what did not go by the script is told", "[harness]")
{
    Script script;
    script.server.accept_session();
    script.server.allow<PublishRequest>();
    script.server.expect<WriteRequest>().reply(WriteResponse{});
    REQUIRE(script.client.open());
    script.client.send<PublishResponse>(PublishRequest{}, [](const Result<PublishResponse>&) {});
    CHECK(script.client.call<ReadResponse>(read_request({})).error() ==
          status::Bad_ServiceUnsupported);
    CHECK_THAT(script.server.report(),
               Catch::Contains("expected WriteRequest, came ReadRequest at 0.0") &&
                   Catch::Contains("expected WriteRequest, came nothing"));
    CHECK(script.server.came() == std::vector<std::string>{"CreateSessionRequest",
                                                           "ActivateSessionRequest",
                                                           "PublishRequest", "ReadRequest"});
}

TEST_CASE("a scripted client speaks to a server out of turn", "[harness]")
{
    World world;
    ServerHost server{world};
    ScriptedClient client{world, channel_config()};
    REQUIRE(client.open());
    // Part 4, 5.5.4: before there is a session.
    REQUIRE(client.send(GetEndpointsRequest{}));
    const auto endpoints = client.expect<GetEndpointsResponse>();
    REQUIRE(endpoints);
    CHECK(endpoints->endpoints.size() == 1);
    CHECK(client.report() == "");

    REQUIRE(client.send(read_request({})));
    CHECK(client.expect<ReadResponse>().error() == status::Bad_SessionIdInvalid);
    CHECK(client.report() == "expected ReadResponse, came ServiceFault Bad_SessionIdInvalid\n");

    CHECK(client.expect<ReadResponse>(1s).error() == status::Bad_Timeout);
    const std::array<std::byte, 8> nonsense{};
    client.send_bytes(nonsense);
    CHECK(client.expect_close().value() == status::Bad_TcpMessageTypeInvalid);
    world.run_for(1s);
    CHECK(server.server().connection_count() == 0);
}

TEST_CASE("a scripted client learns why there is no channel", "[harness]")
{
    World world;
    ScriptedClient client{world, channel_config()};
    CHECK(client.open().error() == status::Bad_ConnectionRejected);
    CHECK(client.send(GetEndpointsRequest{}).error() == status::Bad_NotConnected);
    ServerHost server{world};
    world.network().play(fault::hold());
    CHECK(client.open(1s).error() == status::Bad_Timeout);
    world.network().play(fault::hold().at(Message{"HEL"}));
    const auto late = client.open(1h);
    REQUIRE_FALSE(late);
    CHECK(world.now() < TimePoint{10min});
    world.network().play(fault::cut().at(Message{"ACK"}));
    CHECK(client.open().error() == status::Bad_ConnectionClosed);
    CHECK(client.open().has_value());
}

TEST_CASE("a scripted client reports the end, whether it was expected or not", "[harness]")
{
    World world;
    ServerHost server{world};
    {
        ScriptedClient client{world, channel_config()};
        REQUIRE(client.open());
        REQUIRE(client.open()); // leaves the first connection without notice
        world.run_for(1s);
        CHECK(server.server().connection_count() == 1);
        CHECK(client.expect_close(1s).error() == status::Bad_Timeout);
        CHECK(client.report() == "expected the end, which did not come\n");
        world.network().cut();
        CHECK(client.expect<ReadResponse>().error() == status::Bad_ConnectionClosed);
        CHECK_THAT(client.report(), Catch::Contains("expected ReadResponse, came the end Good\n"));
        CHECK(client.expect_close().value() == status::Good);
        CHECK(client.send(GetEndpointsRequest{}).error() == status::Bad_NotConnected);
        client.send_bytes(std::array<std::byte, 1>{});
        REQUIRE(client.open());
        // What came before the end is still there.
        REQUIRE(client.send(GetEndpointsRequest{}));
        world.run_for(1s);
        world.network().cut();
        world.run_for(1s);
        CHECK(client.expect<GetEndpointsResponse>().has_value());
        REQUIRE(client.open());
        REQUIRE(client.send(GetEndpointsRequest{}));
        CHECK(client.expect<ReadResponse>().error() == status::Bad_UnknownResponse);
        CHECK_THAT(client.report(), Catch::Contains("expected ReadResponse, came "
                                                    "GetEndpointsResponse Bad_UnknownResponse\n"));
    }
    world.run_for(1s);
    CHECK(server.server().connection_count() == 0);
}

TEST_CASE("users of a test log in by their password", "[harness]")
{
    TestUsers users;
    users.add("operator", "secret");
    BenchOptions options;
    options.server.identity = make_identity({}).value(); // passwords are encrypted for it
    options.server.endpoints[0].allows_user_name = true;
    options.client.channel.server_certificate = options.server.identity->certificates.front();
    options.server_parts.users = &users;
    options.client.identity = client::NamedUser{"operator", "secret"};
    CHECK_THAT(BenchFixture{options}.connect(), succeeds<void>());
    options.client.identity = client::NamedUser{"operator", "wrong"};
    CHECK(BenchFixture{options}.connect().error() == status::Bad_UserAccessDenied);
}

TEST_CASE("values are shown as a test wants to read them", "[harness]")
{
    CHECK(text_of(status::Bad_Timeout) == "Bad_Timeout");
    CHECK(text_of(StatusCode{0x800A0401}) == "Bad_Timeout (0x800a0401)");
    CHECK(text_of(Variant{}) == "null");
    CHECK(text_of(Variant{std::int32_t{-4}}) == "Int32 -4");
    CHECK(text_of(Variant{true}) == "Boolean true");
    CHECK(text_of(Variant{"a\n"}) == "String \"a\\x0A\"");
    CHECK(text_of(Variant{Array<double>{1, 2.5}}) == "Double[2] {1, 2.5}");
    CHECK(text_of(Variant{Array<Variant>{Variant{true}}}) == "Variant[1] {Boolean true}");
    CHECK(text_of(DataValue{Variant{std::uint8_t{3}}, status::Uncertain_LastUsableValue,
                            DateTime::from_unix_seconds(0)}) ==
          "Byte 3, Uncertain_LastUsableValue, source 1970-01-01T00:00:00Z");
    CHECK(text_of(StatusCode{0x80FF0000}) == "0x80ff0000");
    CHECK(text_of(Variant{false}) == "Boolean false");
    CHECK(text_of(Variant{String{}}) == "String null");
    CHECK(text_of(Variant{ByteString{std::as_bytes(std::span{"ab", 2})}}) == "ByteString 2 bytes");
    CHECK(text_of(Variant{LocalizedText{"en", "a\t"}}) == "LocalizedText \"a\\x09\"");
    CHECK(text_of(Variant{StatusCode{status::Bad_Timeout}}) == "StatusCode Bad_Timeout");
    CHECK(text_of(Variant{NodeId{1, 5U}}) == "NodeId ns=1;i=5");
    CHECK(text_of(Variant{ExtensionObject::from_id(NodeId{1, 5U})}) == "ExtensionObject ...");
    CHECK(text_of(Variant{Array<std::uint8_t>{std::vector<std::uint8_t>(17, 1)}}) ==
          "Byte[17] {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, ...}");
    DataValue timed{Variant{std::uint8_t{3}}};
    timed.server_timestamp = DateTime::from_unix_seconds(0);
    CHECK(text_of(timed) == "Byte 3, server 1970-01-01T00:00:00Z");
    CHECK(Catch::Detail::stringify(NodeId{1, "Level"}) == "ns=1;s=Level");
}

TEST_CASE("a scripted client says when it sends", "[harness]")
{
    World world;
    ScriptedServer server{world, "opc.tcp://server:4840"};
    const auto is_timed = [](const auto& request) {
        return request.request_header.timestamp != DateTime{};
    };
    server.expect<CreateSessionRequest>(is_timed).reply(CreateSessionResponse{});
    server.expect<ActivateSessionRequest>(is_timed).reply(ActivateSessionResponse{});
    server
        .expect<ReadRequest>([](const ReadRequest& request) {
            return request.request_header.timestamp == DateTime{7};
        })
        .reply(ReadResponse{});
    channel::ClientChannelConfig config;
    config.endpoint_url = "opc.tcp://server:4840";
    ScriptedClient client{world, config};
    REQUIRE(client.open());
    REQUIRE(client.open_session());
    ReadRequest request;
    request.request_header.timestamp = DateTime{7};
    REQUIRE(client.send(request));
    CHECK(client.expect<ReadResponse>().has_value());
    CHECK(server.report() == "");
}

TEST_CASE("a script that was not followed fails a test that does not look", "[harness]")
{
    static std::string failures;
    const FailTest before = set_fail_test([](const std::string& why) { failures += why; });
    World world;
    const auto with_server = [&](auto work) {
        failures.clear();
        ScriptedServer server{world, "opc.tcp://server:4840"};
        server.expect<WriteRequest>().reply(WriteResponse{});
        work(server);
    };
    with_server([](ScriptedServer&) {});
    CHECK_THAT(failures, Catch::Contains("expected WriteRequest, came nothing"));
    with_server([](ScriptedServer& server) { CHECK_FALSE(server.is_done()); });
    CHECK(failures == "");
    const auto ask_out_of_turn = [&] {
        ConnectionHost client{world};
        CHECK_FALSE(client.open());
    };
    with_server([&](ScriptedServer& server) {
        ask_out_of_turn();
        CHECK_FALSE(server.is_done());
    });
    CHECK_THAT(failures,
               Catch::Contains("expected WriteRequest, came ") && !Catch::Contains("came nothing"));
    with_server([&](ScriptedServer& server) {
        ask_out_of_turn();
        CHECK_FALSE(server.report().empty());
    });
    CHECK(failures == "");
    with_server([](ScriptedServer& server) { server.forgive_report(); });
    CHECK(failures == "");
    with_server([&](ScriptedServer& server) {
        server.forgive_report();
        ScriptedServer doubled{world, "opc.tcp://server:4840"};
    });
    CHECK_THAT(failures, Catch::Contains("does not listen at \"opc.tcp://server:4840\": "
                                         "something else does already"));
    set_fail_test(before);
}

} // namespace scripted_test
