#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/subscription.hpp>

namespace recorded_messages_test {

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

ReadResponse read_response(const World& world, Variant value)
{
    ReadResponse response;
    response.results.push_back(DataValue{std::move(value), {}, world.clock().now()});
    return response;
}

const NodeId level{1, "Level"};
const NodeId state{1, "State"};

/// What happens in a visit of a client, and how it differs from another one.
struct Visit {
    double level{1.5};
    std::uint32_t subscription{5};
    std::uint64_t seed{1};
    bool reads_state{false};
    bool has_ending{true};
};

/// Returns the recording of a visit.
Recording record(const Visit& visit)
{
    World world{visit.seed};
    const auto recorder = std::make_shared<Recorder>(world.seed());
    world.network().set_observer(recorder);
    ScriptedServer server{world, url};
    server.accept_clients();
    server.allow<ReadRequest>(reads(level)).reply([&](const ReadRequest&) {
        return read_response(world, Variant{visit.level});
    });
    server.allow<ReadRequest>(reads(state)).reply(read_response(world, Variant{true}));
    CreateSubscriptionResponse created;
    created.subscription_id = visit.subscription;
    created.revised_publishing_interval = 100;
    server.allow<CreateSubscriptionRequest>().reply(created);
    server.allow<DeleteSubscriptionsRequest>().reply([&](const DeleteSubscriptionsRequest& came) {
        DeleteSubscriptionsResponse response;
        response.results.push_back(came.subscription_ids[0] == visit.subscription
                                       ? StatusCode{}
                                       : status::Bad_SubscriptionIdInvalid);
        return response;
    });
    ConnectionHost client{world};
    need(client.open());
    const auto made = need(client.call<CreateSubscriptionResponse>(CreateSubscriptionRequest{}));
    if (visit.reads_state) {
        need(client.call<ReadResponse>(read_request(state)));
    }
    need(client.call<ReadResponse>(read_request(level)));
    DeleteSubscriptionsRequest end;
    end.subscription_ids.push_back(made.subscription_id);
    if (visit.has_ending) {
        need(client.call<DeleteSubscriptionsResponse>(end));
    }
    client.close();
    world.run_for(1s);
    return recorder->recording();
}

std::vector<std::string> compare(const Visit& before, const Visit& after,
                                 const ComparisonOptions& options = {})
{
    return compare_messages(read_messages(record(before)), read_messages(record(after)), options);
}

using Lines = std::vector<std::string>;

} // namespace

TEST_CASE("a recording is read as messages", "[harness]")
{
    const auto messages = read_messages(record({}));
    std::vector<std::string> names;
    for (const RecordedMessage& message : messages) {
        names.push_back(message.name);
        CHECK(message.number == names.size());
    }
    CHECK(names == Lines{"HEL", "ACK", "OPN", "OPN", "CreateSessionRequest",
                         "CreateSessionResponse", "ActivateSessionRequest",
                         "ActivateSessionResponse", "CreateSubscriptionRequest",
                         "CreateSubscriptionResponse", "ReadRequest", "ReadResponse",
                         "DeleteSubscriptionsRequest", "DeleteSubscriptionsResponse",
                         "CloseSessionRequest", "CLO"});
    CHECK_THAT(summary(messages[10]), Catch::Contains("s client -> ReadRequest ns=1;s=Level"));
    CHECK(messages[10].request_id == messages[11].request_id);
    const std::string text = write_messages(messages);
    CHECK_THAT(text, Catch::StartsWith("busbar-messages 1\n\n1 > HEL\n") &&
                         Catch::Contains("\n1 < ReadResponse\n"
                                         "  responseHeader.timestamp: $time\n") &&
                         Catch::Contains("\n  results[0].value: Double 1.5\n"
                                         "  results[0].sourceTimestamp: $time\n") &&
                         Catch::Contains("  subscriptionIds[0]: $subscription1\n") &&
                         Catch::Contains("  requestHeader.authenticationToken: $token"));
}

TEST_CASE("two recordings of the same thing do not differ", "[harness]")
{
    CHECK(compare({}, {}).empty());
    CHECK(compare({}, {.subscription = 4711, .seed = 2}).empty());
    CHECK(write_messages(read_messages(record({}))) ==
          write_messages(read_messages(record({.subscription = 4711, .seed = 2}))));
    CHECK(compare({}, {.level = 1.75}, {.tolerance = 0.25}).empty());
}

TEST_CASE("what differs between two recordings is said by name", "[harness]")
{
    CHECK(compare({}, {.level = 1.75}) ==
          Lines{"ReadResponse to ns=1;s=Level: results[0].value Double 1.5 -> Double 1.75 "
                "(messages 12, 12)"});
    CHECK(compare({}, {.level = 1.75}, {.tolerance = 0.2}).size() == 1);
    CHECK(compare({}, {.reads_state = true}) ==
          Lines{"new: ReadRequest ns=1;s=State (message 11)"});
    CHECK(compare({.reads_state = true}, {.level = 7}) ==
          Lines{"missing: ReadRequest ns=1;s=State (message 11)",
                "ReadResponse to ns=1;s=Level: results[0].value Double 1.5 -> Double 7 "
                "(messages 14, 12)"});
    CHECK(compare({}, {.has_ending = false}) ==
          Lines{"missing: DeleteSubscriptionsRequest subscriptionIds 5 (message 13)"});
    CHECK(compare({.reads_state = true}, {.level = 7}, {.max_lines = 1}) ==
          Lines{"missing: ReadRequest ns=1;s=State (message 11)", "1 more"});
}

TEST_CASE("an id that means another thing is a difference", "[harness]")
{
    auto before = read_messages(record({}));
    auto after = before;
    for (RecordedMessage::Field& field : after[12].fields) {
        if (field.path == "subscriptionIds[0]") {
            field.text = "6";
        }
    }
    CHECK(compare_messages(before, after) ==
          Lines{"DeleteSubscriptionsRequest: subscriptionIds[0] 5 -> 6 (messages 13, 13)"});
}

TEST_CASE("times are compared where they are asked for", "[harness]")
{
    auto before = read_messages(record({}));
    auto after = before;
    for (RecordedMessage::Field& field : after[11].fields) {
        if (field.path == "results[0].sourceTimestamp") {
            field.text = "2027-01-01T00:00:00Z";
        }
    }
    CHECK(compare_messages(before, after).empty());
    REQUIRE(compare_messages(before, after, {.with_times = true}).size() == 1);
}

TEST_CASE("the end of a connection is compared with nothing else", "[harness]")
{
    std::vector<RecordedMessage> before(1);
    before[0].number = 1;
    before[0].name = "ERR";
    before[0].from = Side::Server;
    auto after = read_messages(record({}));
    CHECK_FALSE(compare_messages(before, after).empty());
    CHECK_FALSE(compare_messages(after, before).empty());
    // More than are aligned: one by one.
    const auto request = after[10];
    std::vector<RecordedMessage> many(5'000, request);
    for (std::size_t i = 0; i < many.size(); ++i) {
        many[i].request_id = static_cast<std::uint32_t>(i);
    }
    auto ended = many;
    ended[0] = before[0];
    CHECK_FALSE(compare_messages(many, ended, {.max_lines = 3}).empty());
}

TEST_CASE("values that are not shown whole differ all the same", "[harness]")
{
    const auto recorded = [](const Variant& value) {
        World world;
        const auto recorder = std::make_shared<Recorder>(1);
        world.network().set_observer(recorder);
        ScriptedServer server{world, url};
        server.accept_clients();
        server.allow<ReadRequest>(reads(level)).reply(read_response(world, value));
        ConnectionHost client{world};
        need(client.open());
        need(client.call<ReadResponse>(read_request(level)));
        return read_messages(recorder->recording());
    };
    const auto differs = [&](const Variant& a, const Variant& b) {
        return !compare_messages(recorded(a), recorded(b)).empty() &&
               compare_messages(recorded(a), recorded(a)).empty();
    };
    std::vector<std::int32_t> numbers(20, 1);
    const Variant first{Array<std::int32_t>{numbers}};
    numbers.back() = 2;
    CHECK(differs(first, Variant{Array<std::int32_t>{numbers}}));
    CHECK(differs(Variant{String{std::string(300, 'a')}},
                  Variant{String{std::string(299, 'a') + "b"}}));
    CHECK(differs(Variant{ByteString{std::as_bytes(std::span{"ab", 2})}},
                  Variant{ByteString{std::as_bytes(std::span{"ac", 2})}}));
    CHECK(differs(Variant{LocalizedText{"en", "a"}}, Variant{LocalizedText{"de", "a"}}));
    CHECK(differs(Variant{std::int64_t{9'007'199'254'740'993}},
                  Variant{std::int64_t{9'007'199'254'740'992}}));
}

} // namespace recorded_messages_test
