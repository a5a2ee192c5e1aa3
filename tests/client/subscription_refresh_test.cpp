#include <catch2/catch.hpp>

#include <busbar/types/filter.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "puppet_fixture.hpp"
#include "subscriber_fixture.hpp"

namespace subscription_refresh_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using Start = Subscriptions::SessionStart;
using Values = std::vector<std::int32_t>;

namespace {

/// A server that keeps one message, and two variables that are watched, one of them by its path.
struct ForgetfulServer : SubscriberFixture {
    ForgetfulServer() : SubscriberFixture{limits()}
    {
        add_variable("level", 1);
        const NodeId speed = add_variable("speed", 10);
        const auto subscription = subscriptions.create(fast(), heard.handlers()).value();
        client::ItemSettings by_path = item(NodeId{});
        by_path.node = client::NodeAddress::parse("/Objects/1:level").value();
        level_item = add(subscription, by_path);
        add(subscription, item(speed));
        pass(300ms);
        CHECK(heard.take_values().size() == 2);
    }
    [[nodiscard]] static server::SubscriptionLimits limits()
    {
        server::SubscriptionLimits limits = server_limits();
        limits.max_retransmission_messages = 1;
        return limits;
    }
    /// Two messages are sent and lost; the server keeps the second one.
    void lose_level(std::int32_t value)
    {
        set(0, value);
        publish_into_nothing();
        set(1, value);
        publish_into_nothing();
        requester.client().run();
        cut();
        start_again(Start::Resumed);
    }

    ItemHandle level_item{0};

private:
    void publish_into_nothing()
    {
        for (int i = 0; i < 15; ++i) {
            advance(10ms);
        }
    }
};

/// After a Gap in which the values of some items were lost.
struct GapFixture : PuppetFixture {
    /// The second message is lost for good; the third one is about the first item.
    void lose(std::uint32_t number = 2)
    {
        publish(message(number + 1));
        refuse_republish(number);
        CHECK(heard.gaps.size() == 1);
        heard.gaps.clear();
        heard.data.clear();
    }
    void start_and_lose(std::uint32_t count)
    {
        start(count);
        publish(message(1));
        lose();
    }
    [[nodiscard]] static CallResponse called(StatusCode status)
    {
        CallResponse response;
        response.results.resize(1);
        response.results[0].status_code = status;
        return response;
    }
    void refuse_resend(StatusCode status = status::Bad_MethodInvalid)
    {
        static_cast<void>(requester.take<CallRequest>());
        reply(called(status));
    }
    ReadRequest read(std::vector<DataValue> values)
    {
        const auto request = requester.take<ReadRequest>();
        ReadResponse response;
        response.results = Array<DataValue>{values};
        reply(response);
        return request;
    }
};

} // namespace

TEST_CASE_METHOD(ForgetfulServer, "After a Gap the value that is shown is the server's", "[client]")
{
    const bool has_method = GENERATE(true, false);
    if (!has_method) {
        auto& space = server.address_space();
        space.set_executable(space.find(id::Server_ResendData), false);
    }
    lose_level(2);
    pass(2s);
    CHECK(heard.gaps.size() == 1);
    Values level;
    for (const client::DataChange& change : heard.data) {
        if (change.item == level_item) {
            level.push_back(change.value.value.value_or<std::int32_t>(-1));
            CHECK(change.is_read_again != has_method);
        }
    }
    CHECK(level == Values{2});
    pass(20s);
    CHECK(heard.gaps.size() == 1);
}

TEST_CASE_METHOD(GapFixture, "ResendData is called after a Gap",
                 "[client][unit:Base Data Client ResendData Method]")
{
    start_and_lose(2);
    const auto request = requester.take<CallRequest>();
    REQUIRE(request.methods_to_call.size() == 1);
    CHECK(request.methods_to_call[0].object_id == NodeId{0, id::Server});
    CHECK(request.methods_to_call[0].method_id == NodeId{0, id::Server_ResendData});
    CHECK(request.methods_to_call[0].input_arguments == Array<Variant>{Variant{server_id}});
    reply(called(status::Good));
    pass(10s);
    CHECK(requester.count<CallRequest>() == 0);
    CHECK(requester.count<ReadRequest>() == 0);
}

TEST_CASE_METHOD(GapFixture, "What a keep-alive message shows to be lost is asked for", "[client]")
{
    start();
    publish(message(1));
    publish_keep_alive(3);
    CHECK(requester.count<CallRequest>() == 0);
    refuse_republish(2);
    CHECK(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].to == time_of(3));
    CHECK(requester.count<CallRequest>() == 1);
}

TEST_CASE_METHOD(GapFixture, "Nothing is asked for that was told since", "[client]")
{
    start_and_lose(1);
    pass(5s);
    CHECK(requester.count<CallRequest>() == 0);
    CHECK(requester.count<ReadRequest>() == 0);
}

TEST_CASE_METHOD(GapFixture, "Without ResendData values are read in calls of the server's size",
                 "[client]")
{
    requester.info.operation_limits.max_nodes_per_read = 2;
    start_and_lose(4);
    const StatusCode refusal =
        GENERATE(status::Bad_MethodInvalid, status::Bad_NodeIdUnknown, status::Bad_NotImplemented,
                 status::Bad_UserAccessDenied, status::Bad_ServiceUnsupported);
    SECTION("as the Method")
    {
        refuse_resend(refusal);
    }
    SECTION("as the Service")
    {
        static_cast<void>(requester.take<CallRequest>());
        refuse(refusal);
    }
    SECTION("with no result")
    {
        static_cast<void>(requester.take<CallRequest>());
        reply(CallResponse{});
    }
    const auto first = read({DataValue{20}, DataValue{StatusCode{status::Bad_NodeIdUnknown}}});
    REQUIRE(first.nodes_to_read.size() == 2);
    CHECK(first.nodes_to_read[0].node_id == NodeId{1, 2});
    CHECK(first.timestamps_to_return == TimestampsToReturn::Both);
    CHECK(read({DataValue{40}}).nodes_to_read.size() == 1);
    REQUIRE(heard.data.size() == 3);
    CHECK(heard.data[1].value.status == status::Bad_NodeIdUnknown);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(heard.data[i].item == items[i + 1]);
        CHECK(heard.data[i].is_read_again);
    }
    publish(message(4));
    CHECK_FALSE(heard.data.back().is_read_again);
    pass(5s);
    CHECK(requester.count<ReadRequest>() == 0);
}

TEST_CASE_METHOD(GapFixture, "A notification is not followed by a Read that began before",
                 "[client]")
{
    start_and_lose(2);
    refuse_resend();
    auto newer = message(4);
    DataChangeNotification data;
    data.monitored_items.push_back({items[1], DataValue{7}});
    newer.notification_data[0] = ExtensionObject::from(data);
    publish(newer);
    read({DataValue{6}});
    CHECK(heard.take_values() == Values{7});
}

TEST_CASE_METHOD(GapFixture, "What a Read cannot give is not read", "[client]")
{
    subscription = subscriptions.create({}, heard.handlers()).value();
    std::vector<client::ItemSettings> wishes(5);
    for (std::uint32_t i = 0; i < wishes.size(); ++i) {
        wishes[i].node = NodeId{1, i + 1};
    }
    wishes[1].filter = ExtensionObject::from(EventFilter{});
    wishes[2].filter = ExtensionObject::from(AggregateFilter{});
    wishes[3].mode = MonitoringMode::Sampling;
    wishes[4].index_range = "1:2";
    items = subscriptions.add_items(subscription, wishes).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    make_items();
    publish(message(1));
    lose();
    refuse_resend();
    const auto request = read({DataValue{5}});
    REQUIRE(request.nodes_to_read.size() == 1);
    CHECK(request.nodes_to_read[0].node_id == NodeId{1, 5});
    CHECK(request.nodes_to_read[0].index_range == "1:2");
}

TEST_CASE_METHOD(GapFixture, "A server that has refused ResendData is not asked in this session",
                 "[client]")
{
    start_and_lose(2);
    refuse_resend();
    read({DataValue{1}});
    pass(1s);
    lose(4);
    CHECK(requester.count<CallRequest>() == 0);
    read({DataValue{1}});
    subscriptions.session_lost();
    subscriptions.session_started(Start::Resumed);
    settle();
    refuse_republish(6);
    pass(1s);
    lose(6);
    CHECK(requester.count<CallRequest>() == 1);
}

TEST_CASE_METHOD(GapFixture, "What nobody answers is asked for three times", "[client]")
{
    start_and_lose(2);
    for (int i = 0; i < 3; ++i) {
        static_cast<void>(requester.take<CallRequest>());
        refuse(status::Bad_Timeout);
        CHECK(requester.count<CallRequest>() == 0);
        CHECK(requester.count<ReadRequest>() == (i == 2 ? 1 : 0));
        pass(1s);
    }
    for (int i = 0; i < 3; ++i) {
        CHECK(heard.data.empty());
        static_cast<void>(requester.take<ReadRequest>());
        refuse(status::Bad_Timeout);
        CHECK(requester.count<ReadRequest>() == 0);
        pass(1s);
    }
    CHECK(requester.count<ReadRequest>() == 0);
    REQUIRE(heard.data.size() == 1);
    CHECK(heard.data[0].item == items[1]);
    CHECK(heard.data[0].value.status == status::Bad_Timeout);
}

TEST_CASE_METHOD(GapFixture, "What a broken connection has left undone is asked for again",
                 "[client]")
{
    requester.info.operation_limits.max_nodes_per_read = 1;
    start_and_lose(3);
    SECTION("the Call") {}
    SECTION("the first Read")
    {
        refuse_resend();
    }
    SECTION("the second Read")
    {
        refuse_resend();
        read({DataValue{1}});
    }
    subscriptions.session_lost();
    CHECK(subscriptions.next_deadline() == no_deadline);
    pass(2s);
    subscriptions.session_started(Start::Resumed);
    settle();
    CHECK(requester.count<CallRequest>() == 0);
    refuse_republish(4);
    CHECK(requester.count<CallRequest>() == 1);
    CHECK(requester.count<ReadRequest>() == 0);
}

TEST_CASE_METHOD(GapFixture, "However much is lost, values are asked for once a second", "[client]")
{
    start(2);
    publish(message(1));
    int calls = 0;
    for (std::uint32_t number = 3; number < 103; number += 2) {
        publish(message(number));
        refuse_republish(number - 1);
        if (requester.count<CallRequest>() > 0) {
            ++calls;
            refuse_resend(status::Good);
        }
        pass(100ms);
    }
    CHECK(calls >= 4);
    CHECK(calls <= 6);
}

TEST_CASE_METHOD(GapFixture, "Handlers may remove what is read again", "[client]")
{
    auto handlers = heard.handlers();
    handlers.on_data = [this](std::span<const client::DataChange> changes) {
        if (changes[0].is_read_again) {
            static_cast<void>(subscriptions.remove(subscription));
        }
    };
    requester.info.operation_limits.max_nodes_per_read = 1;
    subscription = subscriptions.create({}, handlers).value();
    items = subscriptions.add_items(subscription, std::vector<client::ItemSettings>(3)).value();
    settle();
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created());
    make_items();
    publish(message(1));
    lose();
    refuse_resend();
    read({DataValue{1}});
    CHECK(requester.count<ReadRequest>() == 0);
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "An answer to an old Publish request is heard", "[client]")
{
    start();
    publish(message(1)); // keep-alives come every 10 s
    pass(16s);
    refuse_republish(2);
    CHECK(requester.count<PublishRequest>() == 2);
    pass(16s);
    refuse_republish(2);
    CHECK(requester.count<PublishRequest>() == 4); // they may have been forgotten
    SECTION("which the server has kept")
    {
        publish(message(2));
        publish(message(3));
        CHECK(heard.take_values() == Values{1, 2, 3});
        CHECK(requester.count<RepublishRequest>() == 0);
        CHECK(requester.count<PublishRequest>() == 2);
    }
    SECTION("which are too many for it")
    {
        for (int i = 0; i < 2; ++i) {
            static_cast<void>(requester.take<PublishRequest>());
            refuse(status::Bad_TooManyPublishRequests);
        }
        CHECK(requester.count<PublishRequest>() == 2);
    }
    SECTION("and those that wait are never more than twice as many")
    {
        for (int i = 0; i < 60; ++i) {
            pass(1s);
            CHECK(requester.open_count() <= 5); // and a Republish
        }
    }
    CHECK(heard.gaps.empty());
}

} // namespace subscription_refresh_test
