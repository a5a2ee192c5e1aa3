#include <catch2/catch.hpp>

#include <string>
#include <utility>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/failing_memory.hpp>
#include <busbar/server/event.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/view.hpp>

namespace bench_client_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

const NodeId server_object{0, id::Server};

/// A level in a server, and a client.
class ClientBench : public BenchFixture {
public:
    explicit ClientBench(BenchOptions options = {}) : BenchFixture{std::move(options)} {}

    server::MemorySource& memory{make_source<server::MemorySource>(world().clock())};
    NodeId level{need(add_variable("Level", memory.variable(1.5)))};
    NodeId limit{need(add_variable("Limit", memory.variable(9.0)))};

    void raise(const char* message, std::uint16_t severity = 500)
    {
        server::Event event;
        event.source_node = server_object;
        event.source_name = "Server";
        event.message = LocalizedText{"", message};
        event.severity = severity;
        CHECK(server().raise_event(event));
    }
};

/// Counts its lines.
struct CountingLog final : LogSink {
    void write(LogLevel, std::string_view, std::string_view) override { ++count; }

    int count{0};
};

/// What an exception of a call says.
template <typename Work>
std::string thrown_by(Work work)
{
    try {
        work();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "nothing";
}

} // namespace

TEST_CASE_METHOD(ClientBench, "a bench has further clients, each with its session", "[harness]")
{
    CHECK(subscribe(level) == status::Good);
    CHECK(client("hmi").write(level, 2.5) == status::Good);
    CHECK_THAT(client("hmi").read(level), holds(2.5));
    CHECK_THAT(client("scada").read(level), holds(2.5));
    CHECK(&client("hmi") == &client("hmi"));
    CHECK(server().session_count() == 3);
    run_for(1s);
    CHECK_THAT(values(level).back(), holds(2.5));
    CHECK_THROWS_AS(client("hmi").values(level), std::invalid_argument); // the other one watches
    CHECK_THROWS_AS(add_client("hmi", open_connection_config()), std::invalid_argument);

    client("hmi").host().drop();
    CHECK_FALSE(client("hmi").host().is_ready());
    CHECK(client().is_ready());
    CHECK_THAT(client("hmi").read(level), holds(2.5)); // over a new connection
}

TEST_CASE_METHOD(ClientBench, "a further client has a name and weather of its own", "[harness]")
{
    world().network().weather_of("192.0.2.2").min_latency = 2s;
    world().network().weather_of("192.0.2.2").max_latency = 2s;
    CHECK(connect());
    BenchClient& slow = client("slow");
    const TimePoint begin = world().now();
    CHECK_THAT(read(level), holds(1.5));
    CHECK(world().now() - begin < 1s);
    CHECK_THAT(slow.read(level), holds(1.5));
    CHECK(world().now() - begin > 4s);
    CHECK_THAT(world().trace(), Catch::Contains("slow -> ReadRequest ns=1;s=Level"));
    CHECK_THAT(world().trace(), Catch::Contains("client -> ReadRequest ns=1;s=Level"));
}

TEST_CASE_METHOD(ClientBench, "a further client may have options of its own", "[harness]")
{
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = "opc.tcp://sever:4840";
    BenchClient& lost = add_client("lost", config);
    CHECK_THAT(lost.read(level), has_status(status::Bad_ConnectionRejected));
    CHECK_THAT(world().account(), Catch::Contains("there is no listener at opc.tcp://sever:4840"));
    CHECK_THAT(add_client("panel", open_connection_config()).read(level), holds(1.5));
    CHECK_THAT(read(level), holds(1.5));
    CHECK_THAT(world().trace(), Catch::Contains("panel -> ReadRequest ns=1;s=Level"));
    CHECK_THAT(world().trace(), Catch::Contains("client -> ReadRequest ns=1;s=Level"));
}

TEST_CASE("a further client does not write to the log of the first one", "[harness]")
{
    CountingLog log;
    BenchOptions options;
    options.client_parts.log = &log;
    ClientBench bench{options};
    CHECK(bench.client("hmi").subscribe(bench.level, 0ms) == status::Bad_InvalidArgument);
    CHECK(log.count == 0);
    CHECK_THAT(bench.world().account(), Catch::Contains("hmi") && Catch::Contains("an interval"));
    CHECK(bench.subscribe(bench.level, 0ms) == status::Bad_InvalidArgument);
    CHECK(log.count > 0);
}

TEST_CASE_METHOD(ClientBench, "a bench sends requests of any service", "[harness]")
{
    BrowseRequest request;
    request.nodes_to_browse.emplace_back().node_id = NodeId{0, id::ObjectsFolder};
    const auto response = need(call<BrowseResponse>(std::move(request)));
    REQUIRE(response.results.size() == 1);
    CHECK(response.results[0].references.size() >= 2);
    world().network().refuse();
    client().drop();
    CHECK(call<BrowseResponse>(BrowseRequest{}).error() == status::Bad_ConnectionRejected);
}

TEST_CASE_METHOD(ClientBench, "a bench waits for a value", "[harness]")
{
    CHECK_THAT(await(level, 1.5), holds(1.5)); // watched from now on
    REQUIRE(client("other").connect());
    CHECK(client("other").write(level, 2.5) == status::Good);
    run_for(1s);
    CHECK(client("other").write(level, 3.5) == status::Good);
    run_for(1s);
    CHECK(client("other").write(level, 4.5) == status::Good);
    CHECK_THAT(await(level, holds(3.5)), holds(3.5));
    const DataValue large =
        await(level, [](const DataValue& value) { return value.value.value_or<double>(0) > 4; });
    CHECK_THAT(large, holds(4.5));
    CHECK(values(level).empty()); // those before were passed over
}

TEST_CASE_METHOD(ClientBench, "a bench says which values came instead", "[harness]")
{
    REQUIRE(subscribe(level) == status::Good);
    const TimePoint begin = world().now();
    const std::string why = thrown_by([&] { await(level, holds(7.0), 5s); });
    CHECK_THAT(why, Catch::Contains("ns=1;s=Level had no value that holds Double 7") &&
                        Catch::Contains("; 1 came, the last Double 1.5") &&
                        Catch::Contains("seed"));
    CHECK(world().now() - begin == 5s);
    CHECK(values(level).size() == 1);                   // it is still there
    CHECK_THAT(thrown_by([&] { await(limit, 9, 5s); }), // an Int32
               Catch::Contains("holds Int32 9") && Catch::Contains("the last Double 9"));
    CHECK_THAT(thrown_by([&] {
                   await(NodeId{1, "Levle"}, 1.5);
               }),
               Catch::Contains("ns=1;s=Levle cannot be watched: Bad_NodeIdUnknown"));
    const auto never = [](const DataValue& /*value*/) { return false; };
    CHECK_THAT(thrown_by([&] { await(level, never, 0s); }),
               Catch::Contains("satisfies the test's condition"));
}

TEST_CASE_METHOD(ClientBench, "a bench waits no longer than its limit for a connection",
                 "[harness]")
{
    world().network().weather_of("192.0.2.1").min_latency = 20s;
    world().network().weather_of("192.0.2.1").max_latency = 20s;
    const TimePoint begin = world().now();
    CHECK_THAT(thrown_by([&] { await(level, 1.5, 5s); }),
               Catch::Contains("ns=1;s=Level cannot be watched: Bad_Timeout"));
    CHECK(world().now() - begin == 5s);
}

TEST_CASE_METHOD(ClientBench, "a bench waits for a value past a loss", "[harness]")
{
    REQUIRE(subscribe(level) == status::Good);
    CHECK_THAT(await(level, 1.5), holds(1.5));
    world().scheduler().after(1s, [this] { world().network().cut(); });
    world().scheduler().after(1s, [this] { world().network().refuse(); });
    world().scheduler().after(10s, [this] { world().network().refuse(false); });
    CHECK_THAT(await(level, 1.5, 30s), holds(1.5)); // of the new Subscription
    CHECK(world().now() > TimePoint{10s});
    world().network().cut();
    CHECK_THAT(await(level, has_status(status::Bad_ConnectionClosed)),
               has_status(status::Bad_ConnectionClosed));
}

TEST_CASE_METHOD(ClientBench, "a bench collects Events", "[harness]")
{
    CHECK_THROWS_AS(events(server_object), std::invalid_argument);
    REQUIRE(subscribe_events(server_object) == status::Good);
    raise("too full");
    raise("empty", 100);
    run_for(1s);
    const auto seen = events(server_object);
    REQUIRE(seen.size() == 2);
    CHECK(seen[0].message() == "too full");
    CHECK(seen[0]["Severity"] == Variant{std::uint16_t{500}});
    CHECK(seen[0]["EventType"] == Variant{NodeId{0, id::BaseEventType}});
    CHECK(seen[1].message() == "empty");
    CHECK_THROWS_WITH(seen[1]["Limit"], Catch::Contains("the field Limit has not been asked for"));
    CHECK(events(server_object).empty());
}

TEST_CASE_METHOD(ClientBench, "a bench asks for the Events of a selection", "[harness]")
{
    REQUIRE(subscribe_events(server_object, {{"Message"}, {}, 400}) == status::Good);
    raise("low", 399);
    raise("high", 400);
    run_for(1s);
    const auto seen = events(server_object);
    REQUIRE(seen.size() == 1);
    CHECK(seen[0].message() == "high");
    CHECK(seen[0].fields.size() == 1);

    CHECK(subscribe_events(server_object, {{"Mesage"}, {}, 0}).is_bad());
    CHECK_THAT(world().account(), Catch::Contains("Events do not have the field Mesage"));
    CHECK(subscribe_events(level).is_bad()); // a Variable has none
    raise("once more");
    run_for(1s);
    CHECK(events(server_object).size() == 1); // the refused one has left nothing
}

TEST_CASE_METHOD(ClientBench, "a bench waits for an Event", "[harness]")
{
    REQUIRE(subscribe_events(server_object) == status::Good);
    world().scheduler().after(2s, [this] { raise("first"); });
    world().scheduler().after(4s, [this] { raise("second", 900); });
    CHECK(await_event(server_object, "second")["Severity"] == Variant{std::uint16_t{900}});
    CHECK(events(server_object).empty());
    world().scheduler().after(2s, [this] { raise("third", 900); });
    const auto is_severe = [](const BenchEvent& event) {
        return event["Severity"] == Variant{std::uint16_t{900}};
    };
    CHECK(await_event(server_object, is_severe).message() == "third");
    world().scheduler().after(2s, [this] { raise("fourth"); });
    CHECK_THAT(thrown_by([&] { await_event(server_object, "fith", 5s); }),
               Catch::Contains("i=2253 had no Event that has the Message \"fith\"") &&
                   Catch::Contains("1 came, the last EventType NodeId") &&
                   Catch::Contains("fourth"));
}

TEST_CASE_METHOD(ClientBench, "a bench tells of lost Events and watches again", "[harness]")
{
    REQUIRE(subscribe_events(server_object) == status::Good);
    REQUIRE(subscribe(level) == status::Good);
    run_for(1s);
    world().network().cut();
    run_for(1s);
    const auto lost = events(server_object);
    REQUIRE(lost.size() == 1);
    CHECK(lost[0].status == status::Bad_ConnectionClosed);
    CHECK(lost[0].message().empty());
    CHECK(lost[0]["Severity"] == Variant{});
    CHECK(lost[0]["Limit"] == Variant{});
    CHECK(connect());
    raise("again");
    CHECK(await_event(server_object, "again").status == status::Good);
    CHECK_THAT(values(level).back(), holds(1.5));

    world().network().cut();
    world().scheduler().after(5s, [this] { raise("severe", 900); });
    const auto is_severe = [](const BenchEvent& event) {
        return event["Severity"] == Variant{std::uint16_t{900}}; // also asked of the loss
    };
    CHECK(await_event(server_object, is_severe).message() == "severe");
}

TEST_CASE("memory of a bench's server fails where a test says", "[harness]")
{
    FailingMemory memory;
    BenchOptions options;
    options.server_parts.watch = &memory;
    std::size_t refused = 0;
    bool has_failed = true;
    for (std::size_t k = 1; has_failed; ++k) {
        ClientBench bench{options};
        REQUIRE(bench.connect());
        memory.fail(k);
        const DataValue value = bench.read(bench.level);
        has_failed = memory.has_failed();
        memory.fail(0);
        INFO("allocation " << k << ": " << text_of(value));
        CHECK((value.status.is_good() || has_failed));
        refused += value.status.is_bad() ? 1 : 0;
        CHECK_THAT(bench.read(bench.level), holds(1.5)); // as if nothing had been
        REQUIRE(k < 1'000);
    }
    CHECK(refused > 0);
}

TEST_CASE("what a test allocates beside the server does not fail", "[harness]")
{
    FailingMemory memory;
    memory.fail(1, 1'000'000);
    CHECK(std::string(100, 'x').size() == 100);
    CHECK_FALSE(memory.has_failed());
    std::string text;
    CHECK_FALSE(survives_counted([&] { text = std::string(100, 'x'); }));
    CHECK(memory.has_failed());
    CHECK(survives_counted([&] {
        const Uncounted own;
        text = std::string(100, 'x');
    }));
    memory.fail(2);
    CHECK(survives_counted([&] { text = std::string(200, 'x'); }));
    CHECK_FALSE(memory.has_failed());
    CHECK_FALSE(survives_counted([&] { text = std::string(400, 'x'); }));
    fail_allocation(0);
    fail_large_allocations(1'000);
    CHECK(survives_counted([&] { text = std::string(800, 'x'); }));
    CHECK_FALSE(survives_counted([&] { text = std::string(2'000, 'x'); }));
    fail_large_allocations(0);
    CHECK(survives_counted([&] { text = std::string(2'000, 'x'); }));
}

} // namespace bench_client_test
