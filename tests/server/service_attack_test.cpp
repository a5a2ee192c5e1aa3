#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include <busbar/types/history.hpp>
#include <busbar/types/method.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/query.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "management_fixture.hpp"
#include "method_fixture.hpp"
#include "session_use.hpp"

namespace service_attack_test {

// Services that are asked without a session, in floods, with garbage, and for what is not the
// user's (tests/attacks.txt, A, D and E).

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Calls `what` with the types of each service that needs a session.
template <typename F>
void for_services_of_sessions(F&& what)
{
    what.template operator()<ReadRequest, ReadResponse>("Read");
    what.template operator()<WriteRequest, WriteResponse>("Write");
    what.template operator()<BrowseRequest, BrowseResponse>("Browse");
    what.template operator()<BrowseNextRequest, BrowseNextResponse>("BrowseNext");
    what.template operator()<TranslateBrowsePathsToNodeIdsRequest,
                             TranslateBrowsePathsToNodeIdsResponse>("TranslateBrowsePaths");
    what.template operator()<RegisterNodesRequest, RegisterNodesResponse>("RegisterNodes");
    what.template operator()<UnregisterNodesRequest, UnregisterNodesResponse>("UnregisterNodes");
    what.template operator()<CallRequest, CallResponse>("Call");
    what.template operator()<AddNodesRequest, AddNodesResponse>("AddNodes");
    what.template operator()<AddReferencesRequest, AddReferencesResponse>("AddReferences");
    what.template operator()<DeleteNodesRequest, DeleteNodesResponse>("DeleteNodes");
    what.template operator()<DeleteReferencesRequest, DeleteReferencesResponse>("DeleteReferences");
    what.template operator()<CreateMonitoredItemsRequest, CreateMonitoredItemsResponse>(
        "CreateMonitoredItems");
    what.template operator()<ModifyMonitoredItemsRequest, ModifyMonitoredItemsResponse>(
        "ModifyMonitoredItems");
    what.template operator()<SetMonitoringModeRequest, SetMonitoringModeResponse>(
        "SetMonitoringMode");
    what.template operator()<SetTriggeringRequest, SetTriggeringResponse>("SetTriggering");
    what.template operator()<DeleteMonitoredItemsRequest, DeleteMonitoredItemsResponse>(
        "DeleteMonitoredItems");
    what.template operator()<CreateSubscriptionRequest, CreateSubscriptionResponse>(
        "CreateSubscription");
    what.template operator()<ModifySubscriptionRequest, ModifySubscriptionResponse>(
        "ModifySubscription");
    what.template operator()<SetPublishingModeRequest, SetPublishingModeResponse>(
        "SetPublishingMode");
    what.template operator()<PublishRequest, PublishResponse>("Publish");
    what.template operator()<RepublishRequest, RepublishResponse>("Republish");
    what.template operator()<TransferSubscriptionsRequest, TransferSubscriptionsResponse>(
        "TransferSubscriptions");
    what.template operator()<DeleteSubscriptionsRequest, DeleteSubscriptionsResponse>(
        "DeleteSubscriptions");
    what.template operator()<CancelRequest, CancelResponse>("Cancel");
}

template <typename Request>
void prepare(TestClient& client, Request request)
{
    request.request_header.authentication_token = client.authentication_token;
    REQUIRE(client.channel.send([&](binary::Writer& writer) {
        encode(writer, NodeId{0, Request::binary_encoding_id});
        encode(writer, request);
    }));
}

/// The header of a ServiceFault.
ResponseHeader fault_of(TestClient& client, std::uint32_t request)
{
    client.run();
    REQUIRE(client.messages.size() == 1);
    CHECK(client.messages.front().request_id == request);
    binary::Reader reader{client.messages.front().body};
    NodeId type;
    decode(reader, type);
    CHECK(type == NodeId{0, ServiceFault::binary_encoding_id});
    ResponseHeader header;
    decode(reader, header);
    CHECK(reader.ok());
    client.messages.clear();
    return header;
}

} // namespace

TEST_CASE_METHOD(ManagementFixture, "every service needs an activated session", "[attack]")
{
    for_services_of_sessions([&]<typename Request, typename Response>(const char* name) {
        INFO(name);
        auto stranger = connect();
        CHECK(stranger.status_of<Response>(Request{}) == status::Bad_SessionIdInvalid);
        REQUIRE(stranger.create_session());
        CHECK(stranger.status_of<Response>(Request{}) == status::Bad_SessionNotActivated);
        CHECK(stranger.activate(TestClient::anonymous()) == status::Bad_SessionIdInvalid);
        auto thief = connect();
        thief.adopt(client);
        CHECK(thief.status_of<Response>(Request{}) == status::Bad_SecureChannelIdInvalid);
    });
    CHECK(use(client) == status::Good);
    CHECK(server.session_count() == 1);
    CHECK(server.subscription_count() == 0);
}

TEST_CASE_METHOD(ManagementFixture,
                 "services that a server does not have are none without a session", "[attack]")
{
    const auto refused = [](TestClient& by) {
        CHECK(by.status_of<HistoryReadResponse>(HistoryReadRequest{}) ==
              status::Bad_ServiceUnsupported);
        CHECK(by.status_of<HistoryUpdateResponse>(HistoryUpdateRequest{}) ==
              status::Bad_ServiceUnsupported);
        CHECK(by.status_of<RegisterServerResponse>(RegisterServerRequest{}) ==
              status::Bad_ServiceUnsupported);
        CHECK(by.status_of<RegisterServer2Response>(RegisterServer2Request{}) ==
              status::Bad_ServiceUnsupported);
        CHECK(by.status_of<QueryFirstResponse>(QueryFirstRequest{}) ==
              status::Bad_ServiceUnsupported);
    };
    // Whatever they hold: ranges, continuation points and paths are not looked at.
    HistoryReadRequest history;
    history.nodes_to_read.resize(100);
    history.nodes_to_read[0].index_range = String{std::string(1'000, ',')};
    history.nodes_to_read[0].continuation_point = ByteString{std::vector<std::byte>(1'000)};
    CHECK(client.status_of<HistoryReadResponse>(history) == status::Bad_ServiceUnsupported);
    RegisterServerRequest registration;
    registration.server.semaphore_file_path = "../../x";
    registration.server.discovery_urls = {String{"opc.tcp://a/" + std::string(50'000, 'x')}};
    CHECK(client.status_of<RegisterServerResponse>(registration) == status::Bad_ServiceUnsupported);
    refused(client);
    auto stranger = connect();
    refused(stranger);
}

TEST_CASE_METHOD(ManagementFixture, "requests that end early are answered one by one", "[attack]")
{
    auto good = log_in();
    for (int i = 0; i < 200; ++i) {
        const auto sent = client.send_bytes([&](binary::Writer& writer) {
            RequestHeader header;
            header.authentication_token = client.authentication_token;
            encode(writer, NodeId{0, WriteRequest::binary_encoding_id});
            encode(writer, header);
            writer.number(std::uint8_t{0xFF});
        });
        CHECK(fault_of(client, sent).service_result == status::Bad_DecodingError);
        if (i % 50 == 0) {
            CHECK(use(good) == status::Good);
        }
    }
    CHECK(use(client) == status::Good);
}

TEST_CASE_METHOD(ManagementFixture, "a text that is not UTF-8 gets nowhere", "[attack]")
{
    const String bad{"ok\xff\xfe\xed\xa0\x80"};
    WriteRequest write;
    write.nodes_to_write.resize(1);
    write.nodes_to_write[0].node_id = NodeId{0, id::Server};
    write.nodes_to_write[0].attribute_id = 13;
    write.nodes_to_write[0].value.value = Variant{bad};
    CHECK(client.status_of<WriteResponse>(write) == status::Bad_DecodingError);
    write.nodes_to_write[0].value.value = Variant{1};
    write.nodes_to_write[0].node_id = NodeId{1, bad};
    CHECK(client.status_of<WriteResponse>(write) == status::Bad_DecodingError);
    AddNodesRequest add;
    add.nodes_to_add.resize(1);
    add.nodes_to_add[0].browse_name = QualifiedName{1, bad};
    CHECK(client.status_of<AddNodesResponse>(add) == status::Bad_DecodingError);
    BrowseRequest browse;
    browse.nodes_to_browse.resize(1);
    browse.nodes_to_browse[0].node_id = NodeId{1, bad};
    CHECK(client.status_of<BrowseResponse>(browse) == status::Bad_DecodingError);
    TestClient stranger = connect();
    CreateSessionRequest create = stranger.create_request();
    create.session_name = bad;
    CHECK(stranger.status_of<CreateSessionResponse>(create) == status::Bad_DecodingError);
    // The same without it.
    write.nodes_to_write[0].node_id = NodeId{1, "ok"};
    CHECK(client.status_of<WriteResponse>(write) == status::Good);
}

TEST_CASE("a fault tells nothing but its status", "[attack]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    const auto is_bare = [](const ResponseHeader& header) {
        return header.service_diagnostics.is_null() && header.string_table.empty() &&
               header.additional_header == ExtensionObject{};
    };
    const auto fault = [&](RequestHeader header, std::size_t garbage) {
        return fault_of(client, client.send_bytes([&](binary::Writer& writer) {
            encode(writer, NodeId{0, ReadRequest::binary_encoding_id});
            encode(writer, header);
            writer.bytes(std::vector<std::byte>(garbage, std::byte{0xA5}));
        }));
    };
    CHECK(is_bare(fault({}, 0)));
    RequestHeader stale;
    stale.timestamp = DateTime{1};
    CHECK(is_bare(fault(stale, 30)));
    CHECK(is_bare(fault_of(client, client.send_bytes([](binary::Writer& writer) {
        writer.bytes(std::vector<std::byte>(100, std::byte{0xFF}));
    }))));
    REQUIRE(client.open_session() == status::Good);
    RequestHeader own;
    own.authentication_token = client.authentication_token;
    const ResponseHeader garbled = fault(own, 30);
    CHECK(garbled.service_result.is_bad());
    CHECK(is_bare(garbled));
    CHECK(is_bare(fault(own, 0)));
}

TEST_CASE("ten thousand requests at once wait without growing what waits for the peer", "[attack]")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_send_queue = 20'000;
    ServerFixture fixture{std::move(config)};
    auto flood = fixture.log_in();
    auto good = fixture.log_in();
    for (int i = 0; i < 10'000; ++i) {
        prepare(flood, read_state());
    }
    const auto bytes = take_output(flood.channel);
    for (std::size_t at = 0; at < bytes.size(); at += 65'536) {
        static_cast<void>(flood.connection.feed(
            std::span{bytes}.subspan(at, std::min<std::size_t>(65'536, bytes.size() - at)),
            fixture.now));
        CHECK(flood.connection.output().size() <= 20'000);
        REQUIRE(use(good) == status::Good);
    }
    // A peer that takes its answers gets them all.
    std::size_t answered = 0;
    for (int turns = 0; answered < 10'000 && turns < 10'000; ++turns) {
        carry(flood.connection, flood.channel, fixture.now);
        while (auto event = flood.channel.next_event()) {
            answered += event->kind == channel::ChannelEvent::Kind::Message ? 1U : 0U;
        }
        flood.connection.handle_deadline(fixture.now);
    }
    CHECK(answered == 10'000);
    CHECK(use(good) == status::Good);
}

TEST_CASE_METHOD(MethodFixture, "a session and its channel end while a hundred Calls wait",
                 "[attack]")
{
    const NodeId slow = add_slow("Slow");
    auto good = log_in();
    for (const bool closes_session : {true, false}) {
        auto client = log_in();
        for (int i = 0; i < 100; ++i) {
            prepare(client, request({to_call(slow, {Variant{i}}), to_call(slow, {Variant{i}})}));
        }
        if (closes_session) {
            CloseSessionRequest close;
            close.delete_subscriptions = true;
            prepare(client, close);
        }
        client.channel.close();
        carry(client.channel, client.connection, now);
        while (client.connection.next_deadline() <= now) {
            CHECK(use(good) == status::Good);
            client.connection.handle_deadline(now);
        }
        CHECK(client.is_closed());
        CHECK(use(good) == status::Good);
        CHECK(server.session_count() == (closes_session ? 1 : 2));
    }
    REQUIRE_FALSE(calls.empty());
    while (!calls.empty()) { // the answers come when nobody is there
        calls.front().succeed({Variant{1}});
        calls.pop_front();
    }
    server.handle_completions(now);
    CHECK(use(good) == status::Good);
    advance(60s);
    CHECK(server.session_count() == 0);
}

TEST_CASE_METHOD(MethodFixture, "a request is carried out for whom it came from", "[attack]")
{
    std::vector<std::string> callers;
    const NodeId who = add("Who", {}, {}, [&](server::MethodCall call) {
        callers.push_back(call.caller().user.name);
        call.succeed();
    });
    const NodeId slow = add_slow("Slow");
    auto client = log_in(encrypt);
    // One waits in the backend, one lies in the same bytes before the new user, one behind him.
    prepare(client, request({to_call(slow, {Variant{1}})}));
    prepare(client, request({to_call(who)}));
    ActivateSessionRequest change;
    change.client_signature = client.signature();
    change.user_identity_token = client.user("engineer", "engineer-secret");
    prepare(client, change);
    prepare(client, request({to_call(who)}));
    client.run();
    CHECK(callers == std::vector<std::string>{"operator", "engineer"});
    REQUIRE(calls.size() == 1);
    CHECK(calls[0].caller().user.name == "operator");
    calls[0].succeed({Variant{2}});
    calls.clear();
    server.handle_completions(now);
    client.run();
    CHECK(client.messages.size() == 4);
}

TEST_CASE("nobody guesses a session's token", "[attack]")
{
    ServerFixture fixture;
    auto client = fixture.connect();
    const auto made = client.create_session();
    auto next = fixture.connect();
    const auto other = next.create_session();
    REQUIRE((made && other));
    const auto bytes = made->authentication_token.opaque().span();
    CHECK(bytes.size() >= 32);
    CHECK(other->authentication_token != made->authentication_token);
    CHECK(other->server_nonce != made->server_nonce);
    // Neither the session's id nor its nonce says anything of it.
    CHECK(made->session_id != made->authentication_token);
    const auto nonce = made->server_nonce.span();
    CHECK(std::search(nonce.begin(), nonce.end(), bytes.begin(), bytes.begin() + 8) == nonce.end());
}

TEST_CASE("a server that starts again numbers its channels from elsewhere", "[attack]")
{
    // Part 6, 6.7.2.2: an id is not likely to be that of a channel before the restart.
    ServerFixture outside;
    const auto first_channel = [&](std::size_t drawn) {
        SeededRandom random;
        std::vector<std::byte> before(drawn);
        REQUIRE(random.fill(before));
        auto server = server::Server::create(ServerFixture::insecure_config(),
                                             {.random = &random,
                                              .wall_clock = &outside.wall_clock,
                                              .log = &outside.log,
                                              .validator = &outside.validator,
                                              .users = &outside.users});
        REQUIRE(server);
        const TestClient client{server->connect("192.0.2.1", outside.now).value(),
                                {},
                                {.random = &random,
                                 .wall_clock = &outside.wall_clock,
                                 .log = &outside.log,
                                 .validator = &outside.validator,
                                 .identity = &client_identity()},
                                outside.now};
        REQUIRE(client.channel.is_open());
        return client.channel.channel_id();
    };
    const std::uint32_t one = first_channel(0);
    const std::uint32_t two = first_channel(16);
    CHECK(one > 1);
    CHECK(two > 1);
    CHECK(one != two);
}

TEST_CASE_METHOD(MethodFixture, "two thousand calls for ConditionRefresh refresh nothing",
                 "[attack]")
{
    auto good = log_in();
    auto client = log_in();
    const NodeId condition_type{0, 2'782U};
    const NodeId condition_refresh{0, 3'875U};
    CallRequest ten;
    ten.methods_to_call.resize(10);
    for (CallMethodRequest& call : ten.methods_to_call) {
        call.object_id = condition_type;
        call.method_id = condition_refresh;
        call.input_arguments = {Variant{std::uint32_t{1}}};
    }
    for (int i = 0; i < 2'000; ++i) {
        const auto response = client.call<CallResponse>(ten);
        REQUIRE(response);
        REQUIRE(response->results.size() == 10);
        REQUIRE(response->results[9].status_code.is_bad());
    }
    CHECK(use(good) == status::Good);
}

} // namespace service_attack_test
