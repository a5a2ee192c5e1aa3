#include <catch2/catch.hpp>

#include "server/session/turn.hpp"
#include "server/subscription_fixture.hpp"
#include "support/slow_server.hpp"

namespace turns_test {

using namespace busbar;
using namespace busbar::test;

namespace {

/// What costs a server most for its size: all nodes are looked at for instances of the type, of
/// which none is to be told.
BrowseRequest dear_browse(std::size_t nodes)
{
    BrowseDescription one;
    one.node_id = NodeId{0, id::PropertyType};
    one.browse_direction = BrowseDirection::Inverse;
    one.include_subtypes = true;
    one.node_class_mask = static_cast<std::uint32_t>(NodeClass::ReferenceType);
    BrowseRequest request;
    request.nodes_to_browse.resize(nodes);
    std::fill(request.nodes_to_browse.begin(), request.nodes_to_browse.end(), one);
    return request;
}

/// How many of the dear nodes take so many turns, with any namespace 0.
std::size_t nodes_for_turns(ServerFixture& fixture, std::size_t turns)
{
    return turns * server::detail::Turn::units / fixture.server.address_space().node_count() + 1;
}

/// Puts a request into the channel and sends nothing yet.
template <typename Request>
void prepare(TestClient& client, Request request)
{
    request.request_header.authentication_token = client.authentication_token;
    REQUIRE(client.channel.send([&](binary::Writer& writer) {
        encode(writer, NodeId{0, Request::binary_encoding_id});
        encode(writer, request);
    }));
}

std::size_t take_answers(TestClient& client, TimePoint now)
{
    carry(client.connection, client.channel, now);
    std::size_t count = 0;
    while (auto event = client.channel.next_event()) {
        count += event->kind == channel::ChannelEvent::Kind::Message ? 1U : 0U;
    }
    return count;
}

} // namespace

TEST_CASE("a connection that asks for much waits for its next turn")
{
    constexpr std::size_t requests = 20;
    ServerFixture fixture;
    auto greedy = fixture.log_in();
    auto good = fixture.log_in();
    const std::size_t nodes = nodes_for_turns(fixture, 2);
    for (std::size_t i = 0; i < requests; ++i) {
        prepare(greedy, dear_browse(nodes));
    }
    carry(greedy.channel, greedy.connection, fixture.now);
    std::size_t answered = take_answers(greedy, fixture.now);
    CHECK(answered < requests);
    std::size_t turns = 0;
    for (; answered < requests; ++turns) {
        REQUIRE(greedy.connection.next_deadline() <= fixture.now);
        REQUIRE(greedy.connection.has_enough());
        // Between any two turns others are served at once.
        if (turns % 16 == 0) {
            REQUIRE(good.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
        }
        greedy.connection.handle_deadline(fixture.now);
        answered += take_answers(greedy, fixture.now);
    }
    CHECK(turns >= requests);
    greedy.connection.handle_deadline(fixture.now);
    CHECK(greedy.connection.next_deadline() > fixture.now);
    CHECK_FALSE(greedy.connection.has_enough());
}

TEST_CASE("what a request was decoded to is paid for while it waits for its turn")
{
    auto config = ServerFixture::insecure_config();
    config.limits.max_session_memory = 60'000;
    ServerFixture fixture{config};
    auto client = fixture.log_in();
    // Some 20 bytes each on the wire, a hundred as an object.
    CHECK(client.status_of<BrowseResponse>(dear_browse(1'000)) == status::Bad_TooManyOperations);
    prepare(client, dear_browse(100));
    carry(client.channel, client.connection, fixture.now);
    std::size_t answered = take_answers(client, fixture.now);
    for (std::size_t turns = 0; answered == 0 && turns < 1'000; ++turns) {
        client.connection.handle_deadline(fixture.now);
        answered += take_answers(client, fixture.now);
    }
    CHECK(answered == 1);
    CHECK(client.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

TEST_CASE("what waits for its turn ends with its session")
{
    ServerFixture fixture;
    auto greedy = fixture.log_in();
    prepare(greedy, dear_browse(nodes_for_turns(fixture, 5)));
    prepare(greedy, CloseSessionRequest{});
    carry(greedy.channel, greedy.connection, fixture.now);
    CHECK(take_answers(greedy, fixture.now) == 0);
    std::size_t answered = 0;
    while (greedy.connection.next_deadline() <= fixture.now) {
        greedy.connection.handle_deadline(fixture.now);
        answered += take_answers(greedy, fixture.now);
    }
    CHECK(answered == 2);
    CHECK(fixture.server.session_count() == 0);
}

TEST_CASE("a connection that goes away takes its turns with it")
{
    ServerFixture fixture;
    auto good = fixture.log_in();
    {
        auto greedy = fixture.log_in();
        prepare(greedy, dear_browse(1'000));
        carry(greedy.channel, greedy.connection, fixture.now);
    }
    CHECK(good.status_of<ReadResponse>(SlowFixture::fast()) == status::Good);
}

namespace {

/// Has the connection go on until the request is answered; how many turns that took.
std::size_t take_turns(TestClient& client, TimePoint now)
{
    carry(client.channel, client.connection, now);
    std::size_t turns = 1;
    while (take_answers(client, now) == 0) {
        REQUIRE(client.connection.next_deadline() <= now);
        client.connection.handle_deadline(now);
        ++turns;
    }
    return turns;
}

} // namespace

TEST_CASE("MonitoredItems are made, changed and deleted in turns")
{
    constexpr std::size_t items = 1'000;
    ServerFixture fixture;
    auto client = fixture.log_in();
    const std::uint32_t id =
        client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
            .value()
            .subscription_id;
    CreateMonitoredItemsRequest create;
    create.subscription_id = id;
    for (std::uint32_t i = 0; i < items; ++i) {
        create.items_to_create.push_back(
            SubscriptionFixture::item_request(NodeId{0, id::Server_ServerStatus_State}, i));
    }
    prepare(client, create);
    CHECK(take_turns(client, fixture.now) >= 10);
    CHECK(fixture.server.monitored_item_count() == items);

    SECTION("changed")
    {
        SetMonitoringModeRequest change;
        change.subscription_id = id;
        change.monitoring_mode = MonitoringMode::Disabled;
        for (std::uint32_t i = 1; i <= items; ++i) {
            change.monitored_item_ids.push_back(i);
        }
        prepare(client, change);
        CHECK(take_turns(client, fixture.now) >= 10);
    }
    SECTION("deleted")
    {
        DeleteMonitoredItemsRequest remove;
        remove.subscription_id = id;
        for (std::uint32_t i = 1; i <= items; ++i) {
            remove.monitored_item_ids.push_back(i);
        }
        prepare(client, remove);
        CHECK(take_turns(client, fixture.now) >= 10);
        CHECK(fixture.server.monitored_item_count() == 0);
    }
}

namespace {

/// Ids of which few are Subscriptions.
Array<std::uint32_t> many_ids(std::uint32_t first)
{
    Array<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < 1'000; ++i) {
        ids.push_back(first + i);
    }
    return ids;
}

std::uint32_t subscribe(TestClient& client)
{
    return client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
        .value()
        .subscription_id;
}

/// The answer to a request of many turns.
template <typename Response, typename Request>
Result<Response> answer_in_turns(TestClient& client, const Request& request, TimePoint now)
{
    const auto sent = client.send(request);
    while (client.connection.next_deadline() <= now) {
        client.connection.handle_deadline(now);
    }
    return client.take<Response>(sent);
}

} // namespace

TEST_CASE("many Subscriptions are paused, moved and deleted in turns")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    const std::uint32_t first = subscribe(client);
    SECTION("paused")
    {
        SetPublishingModeRequest request;
        request.subscription_ids = many_ids(first);
        prepare(client, request);
    }
    SECTION("moved")
    {
        TransferSubscriptionsRequest request;
        request.subscription_ids = many_ids(first);
        prepare(client, request);
    }
    SECTION("deleted")
    {
        DeleteSubscriptionsRequest request;
        request.subscription_ids = many_ids(first);
        prepare(client, request);
    }
    CHECK(take_turns(client, fixture.now) >= 10);
}

TEST_CASE("links between MonitoredItems are made in turns")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    const std::uint32_t id = subscribe(client);
    for (std::uint32_t i = 0; i < 2; ++i) {
        const auto item =
            SubscriptionFixture::item_request(NodeId{0, id::Server_ServerStatus_State}, i);
        CHECK(SubscriptionFixture::monitor(client, id, item).monitored_item_id == i + 1);
    }
    SetTriggeringRequest request;
    request.subscription_id = id;
    request.triggering_item_id = 1;
    request.links_to_add = many_ids(2);
    request.links_to_remove = many_ids(2);
    SECTION("all")
    {
        prepare(client, request);
        CHECK(take_turns(client, fixture.now) >= 3);
        const auto response = answer_in_turns<SetTriggeringResponse>(client, request, fixture.now);
        REQUIRE(response);
        CHECK(response->remove_results.size() == 1'000);
        CHECK(response->remove_results[0] == status::Good);
        CHECK(response->remove_results[1] == status::Bad_MonitoredItemIdInvalid);
        CHECK(response->add_results.size() == 1'000);
        CHECK(response->add_results[0] == status::Good);
        CHECK(response->add_results[1] == status::Bad_MonitoredItemIdInvalid);
    }
    SECTION("until their Subscription ends")
    {
        prepare(client, request);
        carry(client.channel, client.connection, fixture.now);
        while (fixture.server.subscription_count() != 0) {
            fixture.now += std::chrono::seconds{1};
            fixture.server.handle_deadline(fixture.now);
        }
        CHECK(take_turns(client, fixture.now) == 2); // the second finds out
    }
}

TEST_CASE("nodes are registered and unregistered in turns")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 7);
    auto client = fixture.log_in();
    RegisterNodesRequest begin;
    begin.nodes_to_register.assign(10'000, level);
    const auto response = answer_in_turns<RegisterNodesResponse>(client, begin, fixture.now);
    REQUIRE(response);
    REQUIRE(response->registered_node_ids.size() == 10'000);
    CHECK(response->registered_node_ids[0] != level);
    UnregisterNodesRequest end;
    end.nodes_to_unregister = response->registered_node_ids;
    prepare(client, end);
    CHECK(take_turns(client, fixture.now) >= 3);
}

TEST_CASE("a Subscription that ends between turns ends what is done to its items")
{
    ServerFixture fixture;
    auto client = fixture.log_in();
    const std::uint32_t id =
        client.call<CreateSubscriptionResponse>(SubscriptionFixture::subscription_request())
            .value()
            .subscription_id;
    CreateMonitoredItemsRequest create;
    create.subscription_id = id;
    for (std::uint32_t i = 0; i < 1'000; ++i) {
        create.items_to_create.push_back(
            SubscriptionFixture::item_request(NodeId{0, id::Server_ServerStatus_State}, i));
    }
    prepare(client, create);
    carry(client.channel, client.connection, fixture.now);
    CHECK(fixture.server.monitored_item_count() < 1'000);
    // Nobody asks for what it publishes, so its lifetime ends.
    while (fixture.server.subscription_count() != 0) {
        fixture.now += std::chrono::seconds{1};
        fixture.server.handle_deadline(fixture.now);
    }
    CHECK(take_turns(client, fixture.now) == 2); // the second finds out
    CHECK(fixture.server.monitored_item_count() == 0);
}

namespace {

ReadRequest read_of(const NodeId& node, std::size_t count)
{
    ReadValueId one;
    one.node_id = node;
    one.attribute_id = 13;
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Neither;
    request.nodes_to_read.resize(count);
    std::fill(request.nodes_to_read.begin(), request.nodes_to_read.end(), one);
    return request;
}

} // namespace

TEST_CASE("a Read of many structures is answered in turns")
{
    constexpr std::size_t count = 10'000;
    ServerFixture fixture;
    auto client = fixture.log_in();
    prepare(client, read_of(NodeId{0, id::Server_ServerStatus_BuildInfo}, count));
    CHECK(take_turns(client, fixture.now) >= 10);
    const auto sent =
        client.send(read_of(NodeId{0, id::Server_ServerStatus_BuildInfo}, count / 10));
    while (client.connection.next_deadline() <= fixture.now) {
        client.connection.handle_deadline(fixture.now);
    }
    const auto answer = client.take<ReadResponse>(sent);
    REQUIRE(answer);
    REQUIRE(answer->results.size() == count / 10);
    CHECK(answer->results[count / 10 - 1].value.get_if<ExtensionObject>() != nullptr);
}

TEST_CASE("a Write of many values is carried out in turns")
{
    constexpr std::size_t count = 10'000;
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 7);
    auto& space = fixture.server.address_space();
    space.set_access_level(space.find(level), model::Access::ReadWrite, model::Access::ReadWrite);
    fixture.users.everybody.access_level_mask = 0xFF;
    auto client = fixture.log_in();
    WriteValue one;
    one.node_id = level;
    one.attribute_id = 13;
    one.value.value = 8;
    WriteRequest request;
    request.nodes_to_write.resize(count);
    std::fill(request.nodes_to_write.begin(), request.nodes_to_write.end(), one);
    const auto sent = client.send(request);
    StatusCode expected = status::Good;
    SECTION("to the end") {}
    SECTION("to what was removed meanwhile")
    {
        REQUIRE(space.remove(space.find(level)));
        expected = status::Bad_NodeIdUnknown;
    }
    std::size_t turns = 1;
    for (; client.connection.next_deadline() <= fixture.now; ++turns) {
        client.connection.handle_deadline(fixture.now);
    }
    const auto answer = client.take<WriteResponse>(sent);
    REQUIRE(answer);
    REQUIRE(answer->results.size() == count);
    CHECK(answer->results[0] == expected);
    CHECK(answer->results[count - 1] == expected);
    CHECK(turns > 2);
}

namespace {

WriteValue write_of(const NodeId& node, std::int32_t number)
{
    WriteValue write;
    write.node_id = node;
    write.attribute_id = 13;
    write.value.value = number;
    return write;
}

/// Adds a Variable whose value is kept in the address space.
NodeId add_kept(SubscriptionFixture& fixture)
{
    model::NewNode node;
    node.id = NodeId{1, "kept"};
    node.browse_name = QualifiedName{1, "kept"};
    node.parent = fixture.server.address_space().find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    variable.value = Variant{std::int32_t{0}};
    variable.access_level = model::Access::ReadWrite;
    REQUIRE(fixture.server.address_space().add_variable(node, variable));
    return node.id;
}

} // namespace

TEST_CASE("a Write in turns replaces a value of the address space once")
{
    constexpr std::size_t count = 10'000;
    SubscriptionFixture fixture;
    auto& space = fixture.server.address_space();
    const NodeId level = fixture.add_variable("level", 7);
    const NodeId other = fixture.add_variable("other", 7);
    for (const NodeId& node : {level, other}) {
        space.set_access_level(space.find(node), model::Access::ReadWrite,
                               model::Access::ReadWrite);
    }
    fixture.users.everybody.access_level_mask = 0xFF;
    const NodeId kept = add_kept(fixture);
    WriteRequest request;
    request.nodes_to_write.resize(count);
    std::fill(request.nodes_to_write.begin(), request.nodes_to_write.end(), write_of(level, 8));
    request.nodes_to_write[0] = write_of(kept, 1);
    request.nodes_to_write[1] = write_of(other, 9);
    auto client = fixture.log_in();
    const auto sent = client.send(request);
    REQUIRE(client.connection.next_deadline() <= fixture.now);

    // Another client's value, which came later; and a change that makes the plan outdated.
    REQUIRE(space.set_value(space.find(kept), Variant{std::int32_t{2}}));
    REQUIRE(space.remove(space.find(level)));
    while (client.connection.next_deadline() <= fixture.now) {
        client.connection.handle_deadline(fixture.now);
    }
    const auto answer = client.take<WriteResponse>(sent);
    REQUIRE(answer);
    CHECK(space.value(space.find(kept)) == Variant{std::int32_t{2}});
    CHECK(answer->results[0] == status::Good);
    CHECK(answer->results[1] == status::Good);
    CHECK(answer->results[2] == status::Bad_NodeIdUnknown);
    CHECK(answer->results[count - 1] == status::Bad_NodeIdUnknown);
}

TEST_CASE("a plan that is outdated at each turn is made in a few turns")
{
    constexpr std::size_t count = 30'000;
    SubscriptionFixture fixture;
    auto& space = fixture.server.address_space();
    const NodeId level = fixture.add_variable("level", 7);
    space.set_access_level(space.find(level), model::Access::ReadWrite, model::Access::ReadWrite);
    fixture.users.everybody.access_level_mask = 0xFF;
    auto client = fixture.log_in();
    SECTION("read")
    {
        prepare(client, read_of(level, count));
    }
    SECTION("written")
    {
        WriteRequest request;
        request.nodes_to_write.resize(count);
        std::fill(request.nodes_to_write.begin(), request.nodes_to_write.end(), write_of(level, 8));
        prepare(client, request);
    }
    carry(client.channel, client.connection, fixture.now);
    std::size_t turns = 1;
    while (take_answers(client, fixture.now) == 0) {
        REQUIRE(client.connection.next_deadline() <= fixture.now);
        const auto brief = fixture.add_variable(("brief" + std::to_string(turns)).c_str(), 1);
        REQUIRE(space.remove(space.find(brief)));
        client.connection.handle_deadline(fixture.now);
        ++turns;
    }
    CHECK(turns > 2); // not in one that does not end
    CHECK(turns < 10);
}

TEST_CASE("a Read that goes on asks no source for what was removed meanwhile")
{
    SubscriptionFixture fixture;
    const NodeId level = fixture.add_variable("level", 7);
    auto client = fixture.log_in();
    constexpr std::size_t count = 2'000;
    const auto sent = client.send(read_of(level, count));
    REQUIRE(client.connection.next_deadline() <= fixture.now);
    auto& space = fixture.server.address_space();
    REQUIRE(space.remove(space.find(level)));
    while (client.connection.next_deadline() <= fixture.now) {
        client.connection.handle_deadline(fixture.now);
    }
    const auto answer = client.take<ReadResponse>(sent);
    REQUIRE(answer);
    CHECK(answer->results[0].status == status::Bad_NodeIdUnknown);
    CHECK(answer->results[count - 1].status == status::Bad_NodeIdUnknown);
}

} // namespace turns_test
