#include <catch2/catch.hpp>

#include <busbar/types/method.hpp>

#include "method_fixture.hpp"
#include "subscription_fixture.hpp"

namespace server_methods_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const NodeId server_object{0, id::Server};
const NodeId get_monitored_items{0, id::Server_GetMonitoredItems};
const NodeId resend_data{0, id::Server_ResendData};

/// A client with a Subscription of two items, of which only the first is reporting.
struct Fixture : SubscriptionFixture {
    Fixture()
    {
        const NodeId first = add_variable("First", Variant{1});
        const NodeId second = add_variable("Second", Variant{2});
        subscription = subscribe(client);
        auto sampling = item_request(second, 22);
        sampling.monitoring_mode = MonitoringMode::Sampling;
        const auto items = create_items(client, subscription, {item_request(first, 11), sampling});
        REQUIRE(items);
        for (const auto& item : items->results) {
            item_ids.push_back(item.monitored_item_id);
        }
    }
    static CallRequest request(const NodeId& method, Array<Variant> inputs, std::size_t count = 1)
    {
        CallRequest request;
        for (std::size_t i = 0; i < count; ++i) {
            request.methods_to_call.push_back({server_object, method, inputs});
        }
        return request;
    }
    static CallMethodResult call(TestClient& caller, const NodeId& method, Array<Variant> inputs)
    {
        const auto response = caller.call<CallResponse>(request(method, std::move(inputs)));
        REQUIRE(response);
        REQUIRE(response->results.size() == 1);
        return response->results[0];
    }
    static StatusCode status_of(TestClient& caller, const NodeId& method, std::uint32_t id)
    {
        return call(caller, method, {Variant{id}}).status_code;
    }

    TestClient client{log_in()};
    std::uint32_t subscription{0};
    Array<std::uint32_t> item_ids;
};

} // namespace

TEST_CASE_METHOD(Fixture, "GetMonitoredItems lists the handles of a Subscription",
                 "[unit:Base Info GetMonitoredItems Method]")
{
    const auto method = GENERATE(id::Server_GetMonitoredItems, id::ServerType_GetMonitoredItems);
    const auto result = call(client, NodeId{0, method}, {Variant{subscription}});
    CHECK(result.status_code == status::Good);
    REQUIRE(result.output_arguments.size() == 2);
    CHECK(result.output_arguments[0] == Variant{item_ids});
    CHECK(result.output_arguments[1] == Variant{Array<std::uint32_t>{11, 22}});
}

TEST_CASE_METHOD(Fixture, "ResendData brings the values of reporting items again",
                 "[unit:Base Info ResendData Method]")
{
    const auto next_values = [&] {
        const auto id = client.send(PublishRequest{});
        advance(100ms, client);
        const auto response = client.take<PublishResponse>(id);
        REQUIRE(response);
        std::vector<std::uint32_t> handles;
        for (const ExtensionObject& data : response->notification_message.notification_data) {
            const auto* const changes = data.get_if<DataChangeNotification>();
            REQUIRE(changes != nullptr);
            for (const auto& item : changes->monitored_items) {
                handles.push_back(item.client_handle);
            }
        }
        return handles;
    };
    CHECK(next_values() == std::vector<std::uint32_t>{11});
    const auto id = client.send(PublishRequest{});
    advance(100ms, client);
    CHECK_FALSE(client.take<PublishResponse>(id)); // nothing is new
    const auto result = call(client, resend_data, {Variant{subscription}});
    CHECK(result.status_code == status::Good);
    CHECK(result.output_arguments.empty());
    advance(100ms, client);
    const auto response = client.take<PublishResponse>(id);
    REQUIRE(response);
    REQUIRE(response->notification_message.notification_data.size() == 1);
    const auto* const changes =
        response->notification_message.notification_data[0].get_if<DataChangeNotification>();
    REQUIRE(changes != nullptr);
    REQUIRE(changes->monitored_items.size() == 1);
    CHECK(changes->monitored_items[0].client_handle == 11);
    CHECK(changes->monitored_items[0].value.value == Variant{1});
}

TEST_CASE_METHOD(Fixture, "the server's Methods belong to the session that owns the Subscription")
{
    auto other = log_in();
    for (const NodeId& method : {get_monitored_items, resend_data}) {
        CHECK(status_of(client, method, subscription + 1) == status::Bad_SubscriptionIdInvalid);
        CHECK(status_of(other, method, subscription) == status::Bad_UserAccessDenied);
        CHECK(call(client, method, {}).status_code == status::Bad_ArgumentsMissing);
        const auto wrong = call(client, method, {Variant{1}});
        CHECK(wrong.status_code == status::Bad_InvalidArgument);
        CHECK(wrong.input_argument_results == Array<StatusCode>{status::Bad_TypeMismatch});
        CHECK(status_of(client, method, subscription) == status::Good);
    }
}

TEST_CASE("one Call looks at no more monitored items than a request may name")
{
    struct Small : ServerFixture {
        static server::ServerConfig config()
        {
            auto config = insecure_config();
            config.limits.operations.max_monitored_items_per_call = 3;
            return config;
        }
        Small() : ServerFixture{config()} {}
    };
    Small fixture;
    auto client = fixture.log_in();
    const auto made =
        client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request());
    REQUIRE(made);
    const auto item = SubscriptionFixture::item_request(NodeId{0, id::Server_ServerStatus_State});
    REQUIRE(SubscriptionFixture::create_items(client, made->subscription_id, {item, item}));
    const auto response = client.call<CallResponse>(
        Fixture::request(resend_data, {Variant{made->subscription_id}}, 4));
    REQUIRE(response);
    REQUIRE(response->results.size() == 4);
    CHECK(response->results[1].status_code == status::Good);
    CHECK(response->results[2].status_code == status::Bad_TooManyOperations);
    CHECK(response->results[3].status_code == status::Bad_TooManyOperations);
}

TEST_CASE_METHOD(MethodFixture, "arguments are also what a property says that was loaded")
{
    const NodeId method = add("Loaded", {}, {}, [](server::MethodCall call) { call.succeed(); });
    model::NewNode node;
    node.id = own("LoadedInput");
    node.browse_name = QualifiedName{0, "InputArguments"};
    node.parent = space().find(method);
    model::NewVariable property;
    property.value_rank = 1;
    const auto inputs = GENERATE(0, 1, 2);
    if (inputs == 0) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, argument(id::Int32));
        property.value = Array<ExtensionObject>{ExtensionObject::from_binary(
            NodeId{0, Argument::binary_encoding_id}, ByteString{sink.take(writer.written())})};
    } else if (inputs == 1) {
        property.value = Array<ExtensionObject>{
            ExtensionObject::from_binary(NodeId{0, Argument::binary_encoding_id}, ByteString{})};
    } else {
        property.value = Array<String>{"not an Argument"};
    }
    REQUIRE(space().add_property(node, property));
    auto client = log_in();
    const auto result = call(client, to_call(method, {Variant{"text"}}));
    CHECK(result.status_code ==
          (inputs == 0 ? status::Bad_InvalidArgument : status::Bad_InternalError));
}

TEST_CASE("the last values of many items are sent again in turns")
{
    constexpr std::uint32_t items = 1'000;
    constexpr auto cycle = std::chrono::milliseconds{100};
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 7);
    auto client = fixture.log_in();
    const std::uint32_t id = fixture.subscribe(client);
    for (std::uint32_t i = 0; i < items; ++i) {
        REQUIRE(
            SubscriptionFixture::monitor(client, id, SubscriptionFixture::item_request(level, i))
                .status_code == status::Good);
    }
    CHECK(fixture.next_data(client, cycle).size() == items);
    const auto publish = SubscriptionFixture::publish(client);

    CallMethodRequest resend;
    resend.object_id = NodeId{0, id::Server};
    resend.method_id = NodeId{0, id::Server_ResendData};
    resend.input_arguments = {Variant{id}};
    CallRequest call;
    call.methods_to_call = {resend};
    const auto answer = client.call<CallResponse>(call);
    REQUIRE(answer);
    REQUIRE(answer->results[0].status_code == status::Good);
    std::size_t turns = 0;
    for (; fixture.server.next_deadline() <= fixture.now; ++turns) {
        CHECK(SubscriptionFixture::status_of(client, publish) == status::Bad_WouldBlock);
        fixture.server.handle_deadline(fixture.now);
    }
    CHECK(turns >= 4);
    fixture.advance(cycle, client);
    const auto response = SubscriptionFixture::take(client, publish);
    REQUIRE(response);
    CHECK(SubscriptionFixture::data(response->notification_message).size() == items);
}

} // namespace server_methods_test
