#include <algorithm>

#include <catch2/catch.hpp>

#include <busbar/crypto/security_policy.hpp>
#include <busbar/harness/catch.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/request_replay.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

namespace request_replay_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

ReadRequest read_request(const NodeId& node)
{
    ReadRequest request;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = node;
    item.attribute_id = 13;
    return request;
}

/// A server with a level, and what a client does with it.
class Plant {
public:
    explicit Plant(double value, BenchOptions options = {}, const char* name = "Level")
        : bench{std::move(options)}
    {
        level = need(bench.add_variable(name, value));
        bench.world().network().set_observer(recorder);
    }
    /// Reads, watches and ends watching, as client `client`.
    void visit()
    {
        ConnectionHost client{bench.world()};
        need(client.open());
        visit(client);
        client.close();
        bench.run_for(1s);
    }
    void visit(ConnectionHost& client) const
    {
        need(client.call<ReadResponse>(read_request(level)));
        CreateSubscriptionRequest create;
        create.requested_publishing_interval = 100;
        create.requested_lifetime_count = 1'000;
        create.requested_max_keep_alive_count = 10;
        create.publishing_enabled = true;
        const auto created = need(client.call<CreateSubscriptionResponse>(create));
        CreateMonitoredItemsRequest items;
        items.subscription_id = created.subscription_id;
        MonitoredItemCreateRequest& item = items.items_to_create.emplace_back();
        item.item_to_monitor.node_id = level;
        item.item_to_monitor.attribute_id = 13;
        item.monitoring_mode = MonitoringMode::Reporting;
        item.requested_parameters.queue_size = 1;
        const auto made = need(client.call<CreateMonitoredItemsResponse>(items));
        need(client.call<PublishResponse>(PublishRequest{}));
        DeleteMonitoredItemsRequest remove;
        remove.subscription_id = created.subscription_id;
        remove.monitored_item_ids.push_back(made.results[0].monitored_item_id);
        need(client.call<DeleteMonitoredItemsResponse>(remove));
        DeleteSubscriptionsRequest end;
        end.subscription_ids.push_back(created.subscription_id);
        need(client.call<DeleteSubscriptionsResponse>(end));
    }

    Bench bench;
    NodeId level;
    std::shared_ptr<Recorder> recorder = std::make_shared<Recorder>(1);
};

using Lines = std::vector<std::string>;

/// What differs where the recording is repeated.
Lines repeat(const Recording& recording, Plant& plant)
{
    const auto came = replay_requests(plant.bench.world(), recording, open_connection_config());
    return compare_messages(repeated_messages(recording), need(came));
}

} // namespace

TEST_CASE("requests of a recording are repeated in a session of their own", "[harness]")
{
    Plant first{1.5};
    first.visit();
    const Recording recording = first.recorder->recording();
    CHECK(repeated_messages(recording).size() == 12);
    SECTION("the same server again, whose ids are others by now")
    {
        CHECK(repeat(recording, first) == Lines{});
        CHECK(repeat(recording, first) == Lines{});
    }
    SECTION("another server")
    {
        Plant other{1.75};
        CHECK(repeat(recording, other) ==
              Lines{"ReadResponse to ns=1;s=Level: results[0].value Double 1.5 -> Double 1.75 "
                    "(messages 10, 2)",
                    "PublishResponse: notificationMessage.notificationData[0].monitoredItems[0]"
                    ".value.value Double 1.5 -> Double 1.75 (messages 16, 8)"});
    }
    SECTION("a server without the node")
    {
        Plant other{1.5, {}, "Other"};
        const Lines lines = repeat(recording, other);
        CHECK(std::find(lines.begin(), lines.end(),
                        "ReadResponse to ns=1;s=Level: results[0].status nothing -> "
                        "Bad_NodeIdUnknown (messages 10, 2)") != lines.end());
    }
    SECTION("a server that is gone")
    {
        World world;
        CHECK(replay_requests(world, recording, open_connection_config()).error() ==
              status::Bad_ConnectionRejected);
    }
}

TEST_CASE("a recording of a channel without security is repeated on a secured one", "[harness]")
{
    Plant first{1.5};
    first.visit();
    const auto server = make_identity({});
    IdentityOptions client_options;
    client_options.name = "client";
    const auto client = make_identity(client_options);
    BenchOptions options;
    options.server.identity = *server;
    options.server.endpoints[0].security = {crypto::find_policy_by_name("Basic256Sha256"),
                                            MessageSecurityMode::SignAndEncrypt};
    Plant secured{1.5, options};
    client::ConnectionConfig config = open_connection_config();
    config.channel.security = options.server.endpoints[0].security;
    config.channel.server_certificate = server->certificates.front();
    ClientParts parts;
    parts.identity = &*client;
    const auto came =
        replay_requests(secured.bench.world(), first.recorder->recording(), config, parts);
    CHECK(compare_messages(repeated_messages(first.recorder->recording()), need(came)) == Lines{});
    CHECK(repeated_messages(secured.recorder->recording()).empty());
}

TEST_CASE("items of two Subscriptions with one id are told apart in a replay", "[harness]")
{
    // Part 4 has ids of items unique within their Subscription alone.
    World world;
    ScriptedServer old{world, "opc.tcp://server:4840"};
    old.accept_clients();
    const auto recorder = std::make_shared<Recorder>(1);
    world.network().set_observer(recorder);
    ConnectionHost client{world};
    need(client.open());
    for (const std::uint32_t id : {7U, 8U}) {
        CreateSubscriptionResponse response;
        response.subscription_id = id;
        old.expect<CreateSubscriptionRequest>().reply(response);
        CreateMonitoredItemsResponse made;
        made.results.emplace_back().monitored_item_id = 1;
        old.expect<CreateMonitoredItemsRequest>().reply(made);
        CreateSubscriptionRequest create;
        create.requested_publishing_interval = 100;
        create.requested_lifetime_count = 1'000;
        create.requested_max_keep_alive_count = 10;
        need(client.call<CreateSubscriptionResponse>(create));
        CreateMonitoredItemsRequest items;
        items.subscription_id = id;
        MonitoredItemCreateRequest& item = items.items_to_create.emplace_back();
        item.item_to_monitor.node_id = NodeId{1, "Level"};
        item.item_to_monitor.attribute_id = 13;
        need(client.call<CreateMonitoredItemsResponse>(items));
    }
    for (const std::uint32_t id : {7U, 8U}) {
        DeleteMonitoredItemsResponse removed;
        removed.results.push_back(status::Good);
        old.expect<DeleteMonitoredItemsRequest>().reply(removed);
        DeleteMonitoredItemsRequest remove;
        remove.subscription_id = id;
        remove.monitored_item_ids.push_back(1);
        need(client.call<DeleteMonitoredItemsResponse>(remove));
    }
    client.close();
    world.run_for(1s);

    Plant plant{1.5};
    const auto came =
        need(replay_requests(plant.bench.world(), recorder->recording(), open_connection_config()));
    std::size_t removed = 0;
    for (const RecordedMessage& message : came) {
        if (message.name == "DeleteMonitoredItemsResponse") {
            ++removed;
            CHECK(std::find(message.fields.begin(), message.fields.end(),
                            RecordedMessage::Field{"results[0]", "Good"}) != message.fields.end());
        }
    }
    CHECK(removed == 2);
}

TEST_CASE("ContinuationPoints in a replay are those of the new server", "[harness]")
{
    World world;
    ScriptedServer old{world, "opc.tcp://server:4840"};
    old.accept_clients();
    const auto recorder = std::make_shared<Recorder>(1);
    world.network().set_observer(recorder);
    ConnectionHost client{world};
    need(client.open());
    const ByteString point{std::as_bytes(std::span{"the old point", 13})};
    BrowseResponse browsed;
    browsed.results.emplace_back().continuation_point = point;
    browsed.results[0].references.emplace_back();
    old.expect<BrowseRequest>().reply(browsed);
    BrowseNextResponse next;
    next.results.emplace_back().references.emplace_back();
    old.expect<BrowseNextRequest>().reply(next);
    BrowseRequest browse;
    browse.requested_max_references_per_node = 1;
    BrowseDescription& description = browse.nodes_to_browse.emplace_back();
    description.node_id = NodeId{0, 84};
    description.reference_type_id = NodeId{0, 33};
    description.include_subtypes = true;
    need(client.call<BrowseResponse>(browse));
    BrowseNextRequest more;
    more.continuation_points.push_back(point);
    need(client.call<BrowseNextResponse>(more));
    client.close();
    world.run_for(1s);

    Plant plant{1.5};
    const auto came =
        need(replay_requests(plant.bench.world(), recorder->recording(), open_connection_config()));
    REQUIRE(came.size() == 4);
    CHECK(came[3].name == "BrowseNextResponse");
    CHECK(std::none_of(came[3].fields.begin(), came[3].fields.end(), [](const auto& field) {
        return field.text == "Bad_ContinuationPointInvalid";
    }));
    CHECK(std::any_of(came[3].fields.begin(), came[3].fields.end(), [](const auto& field) {
        return field.path.starts_with("results[0].references[0].");
    }));
}

TEST_CASE("a recorded server answers as it did", "[harness]")
{
    Plant first{1.5};
    first.visit();
    const Recording recording = first.recorder->recording();
    World world;
    const RecordedServer server{world, "opc.tcp://server:4840", recording};
    SECTION("to the same requests")
    {
        const auto came = replay_requests(world, recording, open_connection_config());
        CHECK(compare_messages(repeated_messages(recording), need(came)) == Lines{});
        CHECK(server.report() == "");
    }
    SECTION("to a client that does the same")
    {
        ConnectionHost client{world};
        need(client.open());
        first.visit(client);
        CHECK_THAT(need(client.call<ReadResponse>(read_request(first.level))).results[0],
                   holds(1.5));
        CHECK(client.call<PublishResponse>(PublishRequest{}, 1min).error() == status::Bad_Timeout);
        CHECK(server.report() == "");
    }
    SECTION("but not to what was not recorded")
    {
        ConnectionHost client{world};
        need(client.open());
        CHECK(client.call<ReadResponse>(read_request(NodeId{1, "Other"})).error() ==
              status::Bad_ServiceUnsupported);
        CHECK_THAT(server.report(), Catch::Contains("came ReadRequest"));
    }
}

TEST_CASE("what a recorded client did not wait for is not waited for", "[harness]")
{
    Plant first{1.5};
    {
        ConnectionHost client{first.bench.world()};
        need(client.open());
        need(client.call<ReadResponse>(read_request(first.level)));
        CreateSubscriptionRequest create;
        create.requested_publishing_interval = 1'000;
        create.requested_lifetime_count = 1'000;
        create.requested_max_keep_alive_count = 100;
        need(client.call<CreateSubscriptionResponse>(create));
        for (int i = 0; i < 3; ++i) {
            client.send<PublishResponse>(PublishRequest{}, [](const Result<PublishResponse>&) {});
        }
        first.bench.run_for(10ms);
        client.drop();
        first.bench.run_for(1s);
    }
    const Recording recording = first.recorder->recording();
    const TimePoint begin = first.bench.world().now();
    CHECK(repeat(recording, first) == Lines{});
    CHECK(first.bench.world().now() - begin < 5s);
}

} // namespace request_replay_test
