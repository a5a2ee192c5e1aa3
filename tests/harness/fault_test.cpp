#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/server/memory_source.hpp>

namespace fault_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

/// A server with one variable, Level, that its own client reads and writes.
class FaultBench : public BenchFixture {
public:
    FaultBench()
    {
        const model::BoundValue bound = memory_.variable(1.5);
        handle_ = bound.handle;
        level = add_variable("Level", bound).value();
    }
    void set(double value) { memory_.set(handle_, value); }
    [[nodiscard]] double stored() const { return memory_.get(handle_).value.value_or<double>(0); }
    void play(const Fault& fault) { world().network().play(fault); }
    /// A test whose fault never came proves nothing.
    [[nodiscard]] std::string pending() { return world().network().pending_faults(); }

    NodeId level;

private:
    server::MemorySource& memory_{make_source<server::MemorySource>(world().clock())};
    std::uint64_t handle_{0};
};

} // namespace

TEST_CASE_METHOD(FaultBench, "without faults values are read, written and watched", "[harness]")
{
    CHECK_THAT(read(level), holds(1.5));
    CHECK(write(level, 2.5) == status::Good);
    CHECK(subscribe(level) == status::Good);
    run_for(1s);
    set(3.5);
    run_for(1s);
    const auto seen = values(level);
    REQUIRE(seen.size() == 2);
    CHECK_THAT(seen[0], holds(2.5));
    CHECK_THAT(seen[1], holds(3.5));
    CHECK(values(level).empty());
    CHECK_THAT(read(NodeId{1, "Nothing"}), has_status(status::Bad_NodeIdUnknown));
}

TEST_CASE_METHOD(FaultBench, "nothing is lost in bad weather", "[harness]")
{
    Weather& weather = world().network().weather();
    weather.max_latency = 150ms;
    weather.has_random_cuts = true;
    weather.stall_one_in = 5;
    weather.max_stall = 4s;
    REQUIRE(subscribe(level) == status::Good);
    for (int i = 1; i <= 100; ++i) {
        set(i);
        run_for(1s);
    }
    run_for(30s);
    const auto seen = values(level);
    REQUIRE(seen.size() >= 100);
    for (std::size_t i = 0; i < 100; ++i) {
        CHECK_THAT(seen[seen.size() - 100 + i], holds(static_cast<double>(i + 1)));
    }
    CHECK(world().network().connection_count() == 1);
}

TEST_CASE_METHOD(FaultBench, "a connection is cut behind a message, which arrives", "[harness]")
{
    play(fault::cut().after(Message{"PublishResponse", 2}));
    REQUIRE(subscribe(level) == status::Good);
    run_for(1s);
    set(2);
    run_for(1s);
    set(3);
    run_for(1s);
    const auto seen = values(level);
    REQUIRE(seen.size() == 3); // the third value had nobody to go to
    CHECK_THAT(seen[1], holds(2.0));
    CHECK_THAT(seen[2], has_status(status::Bad_ConnectionClosed));
    CHECK_FALSE(client().is_ready());
    CHECK(server().connection_count() == 0);
    CHECK(server().session_count() == 1); // until it times out
    CHECK(pending() == "");
    CHECK_THAT(read(level), holds(3.0)); // over a new connection
}

TEST_CASE_METHOD(FaultBench, "a message before which the connection is cut does not come",
                 "[harness]")
{
    play(fault::cut().before(Message{"WriteRequest"}));
    CHECK(write(level, 9.0) == status::Bad_ConnectionClosed);
    run_for(1s);
    CHECK(stored() == 1.5);
}

TEST_CASE("a connection that is cut at any byte leaves nothing behind", "[harness]")
{
    for (const Side side : {Side::Client, Side::Server}) {
        for (std::uint64_t offset = 0; offset < (side == Side::Client ? 620 : 800); offset += 41) {
            FaultBench bench;
            CAPTURE(static_cast<int>(side), offset);
            bench.play(fault::cut().at_byte(offset).sent_by(side));
            CHECK(bench.read(bench.level).status.is_bad());
            CHECK(bench.pending() == "");
            bench.run_for(2min); // past the timeout of the session
            CHECK(bench.server().connection_count() == 0);
            CHECK(bench.server().session_count() == 0);
            CHECK_THAT(bench.read(bench.level), holds(1.5));
        }
    }
}

TEST_CASE_METHOD(FaultBench, "a delayed message takes its time and is not lost", "[harness]")
{
    REQUIRE(connect());
    play(fault::delay(700ms).at(Message{"ReadResponse"}));
    const TimePoint before = world().now();
    CHECK_THAT(read(level), holds(1.5));
    CHECK(world().now() - before == 702ms);
    CHECK_THAT(read(level), holds(1.5));
    CHECK(world().now() - before == 704ms);
}

TEST_CASE_METHOD(FaultBench, "bytes that are held time out, and arrive when they are let go",
                 "[harness]")
{
    REQUIRE(connect());
    play(fault::hold(15s).before(Message{"WriteRequest"}).sent_by(Side::Client));
    CHECK(write(level, 4.0) == status::Bad_Timeout);
    CHECK(stored() == 1.5);
    run_for(6s);
    CHECK(stored() == 4.0);
    CHECK_THAT(read(level), holds(4.0));
    CHECK(world().network().connection_count() == 1);
}

TEST_CASE_METHOD(FaultBench, "half of a connection stays", "[harness]")
{
    REQUIRE(connect());
    play(fault::half_open());
    run_for(1s);
    CHECK_FALSE(client().is_ready());
    CHECK(server().connection_count() == 1);
    CHECK_THAT(read(level), holds(1.5));
    CHECK(server().connection_count() == 2);
}

TEST_CASE_METHOD(FaultBench, "a session survives that every byte comes for itself", "[harness]")
{
    play(fault::split().times(0));
    CHECK_THAT(read(level), holds(1.5));
    CHECK(pending() == "");
}

TEST_CASE("a flipped bit is seen by whoever gets it", "[harness]")
{
    FaultBench bench;
    SECTION("a message type that is none")
    {
        bench.play(fault::corrupt(0).at(Message{"ACK"}));
        const auto opened = bench.connect();
        REQUIRE_FALSE(opened);
        CHECK(opened.error() == status::Bad_TcpMessageTypeInvalid);
    }
    SECTION("a sequence number")
    {
        REQUIRE(bench.connect());
        bench.play(fault::corrupt(17).at(Message{"ReadRequest"}));
        CHECK(bench.read(bench.level).status.is_bad());
        CHECK(bench.server().connection_count() == 0);
    }
    SECTION("the same by the number of the byte")
    {
        bench.play(fault::corrupt(0, 3).at_byte(1)); // HEL
        CHECK_FALSE(bench.connect());
    }
    CHECK(bench.pending() == "");
    CHECK_THAT(bench.read(bench.level), holds(1.5));
}

TEST_CASE_METHOD(FaultBench, "a request is answered with a fault and does not reach the server",
                 "[harness]")
{
    REQUIRE(connect());
    play(fault::answer(status::Bad_Timeout).at(Message{"WriteRequest", 2}).times(2));
    CHECK(write(level, 2.0) == status::Good);
    CHECK(write(level, 3.0) == status::Bad_Timeout);
    CHECK(write(level, 4.0) == status::Bad_Timeout);
    CHECK(stored() == 2.0);
    // Neither side has noticed more: the numbers of chunks go on, also over a renewal.
    CHECK(write(level, 5.0) == status::Good);
    CHECK(stored() == 5.0);
    for (int i = 0; i < 100; ++i) {
        run_for(30s);
        CHECK_THAT(read(level), holds(5.0));
    }
    CHECK(world().network().connection_count() == 1);
}

TEST_CASE_METHOD(FaultBench, "connections are refused as often as the script says", "[harness]")
{
    play(fault::refuse().times(2));
    CHECK(connect().error() == status::Bad_ConnectionRejected);
    CHECK(connect().error() == status::Bad_ConnectionRejected);
    CHECK(connect().has_value());
    client().drop();
    world().network().refuse();
    CHECK(connect().error() == status::Bad_ConnectionRejected);
    world().network().refuse(false);
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(FaultBench, "the clock jumps while a client watches", "[harness]")
{
    REQUIRE(subscribe(level) == status::Good);
    play(fault::jump_clock(-6h).after(2s));
    run_for(1s);
    set(2);
    run_for(2s);
    set(3);
    run_for(1s);
    const auto seen = values(level);
    REQUIRE(seen.size() == 3);
    CHECK(seen[2].source_timestamp < seen[1].source_timestamp);
    CHECK(client().is_ready());
}

TEST_CASE_METHOD(FaultBench, "what did not happen is told", "[harness]")
{
    world().network().play({fault::cut().after(Message{"PublishResponse", 3}),
                            fault::answer(status::Bad_Timeout).at(Message{"ReadRequest"}),
                            fault::hold().after(90s).on_connection(2)});
    world().network().forgive_pending_faults();
    CHECK(read(level).status == status::Bad_Timeout);
    CHECK(pending() == "cut after PublishResponse 3\nhold after 90 s on connection 2\n");
}

TEST_CASE("a certificate that is another than the client knows is refused", "[harness]")
{
    const auto right = make_identity({});
    const auto wrong = make_identity({});
    IdentityOptions client_options;
    client_options.name = "client";
    const auto own = make_identity(client_options);
    REQUIRE((right && wrong && own));
    BenchOptions options;
    options.server.identity = *wrong;
    options.server.endpoints[0].security = {crypto::find_policy_by_name("Basic256Sha256"),
                                            MessageSecurityMode::SignAndEncrypt};
    options.client_parts.identity = &*own;
    options.client.channel.security = options.server.endpoints[0].security;
    options.client.channel.server_certificate = right->certificates.front();
    BenchFixture refused{options};
    REQUIRE(refused.host().is_running());
    CHECK_FALSE(refused.connect());

    options.client.channel.server_certificate = wrong->certificates.front();
    BenchFixture accepted{options};
    CHECK_THAT(accepted.connect(), succeeds<void>());
    // What a message carries is not seen on its way, but that it is one.
    accepted.world().network().play(
        {fault::answer(status::Bad_Timeout).at(Message{"ReadRequest"}),
         fault::corrupt(100).at(Message{"MSG", 2}).sent_by(Side::Client)});
    const NodeId state{0, 2259U};
    CHECK_THAT(accepted.read(state), holds(std::int32_t{0}));
    CHECK(accepted.read(state).status == status::Bad_SecureChannelClosed);
    accepted.world().network().forgive_pending_faults();
    CHECK(accepted.world().network().pending_faults() == "answer Bad_Timeout at ReadRequest 1\n");
}

TEST_CASE_METHOD(FaultBench, "a fault that could never act is not played", "[harness]")
{
    const auto refused = [&](const Fault& fault, const std::string& why) {
        CHECK_THROWS_WITH(play(fault), Catch::Contains(describe(fault)) && Catch::Contains(why));
    };
    const Message read_request{"ReadRequest"};
    refused(fault::delay(3s).after(1s), "a message or a byte");
    refused(fault::corrupt(10).after(1s), "a message or a byte");
    refused(fault::corrupt(10), "a message or a byte");
    refused(fault::answer(status::Bad_Timeout).after(1s), "a message or a byte");
    refused(fault::answer(status::Bad_Timeout).at_byte(40), "only a message can be answered");
    refused(fault::answer(status::Bad_Timeout).at(Message{"ReadResponse"}), "only requests");
    refused(fault::answer(status::Bad_Timeout).at(read_request).sent_by(Side::Server),
            "only requests");
    refused(fault::delay(1s).after(read_request), "say at()");
    refused(fault::delay(0s).at(read_request), "no time");
    refused(fault::hold(-1s), "negative");
    refused(fault::split(0), "at least one byte");
    refused(fault::split(1).at(Message{"NoSuchRequest"}), "no message is called \"NoSuchRequest\"");
    refused(fault::cut().at(Message{"MSG", 0}), "counted from 1");
    refused(fault::refuse().after(1s), "next connections");
    refused(fault::cut().after(1s).at(read_request), "more than one time");
    // Of a script with one such fault nothing is played.
    CHECK(pending() == "");
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(FaultBench, "a world tells the last messages and what faults did", "[harness]")
{
    play(fault::answer(status::Bad_Timeout).at(Message{"WriteRequest"}));
    CHECK_THAT(read(level), holds(1.5));
    CHECK(write(level, 2.5) == status::Bad_Timeout);
    world().network().cut();
    run_for(10ms);
    CHECK_THAT(read(NodeId{1, "Nothing"}), has_status(status::Bad_NodeIdUnknown));
    const std::string trace = world().trace();
    INFO(trace);
    CHECK_THAT(trace, Catch::Contains("0.009 s [1] client -> ReadRequest ns=1;s=Level\n"));
    CHECK_THAT(trace, Catch::Contains("0.010 s [1] server -> ReadResponse Double 1.5"));
    CHECK_THAT(trace, Catch::Contains("[1] client -> WriteRequest ns=1;s=Level Double 2.5\n"));
    CHECK_THAT(trace, Catch::Contains("[1] network: answer Bad_Timeout at WriteRequest 1\n"));
    CHECK_THAT(trace, Catch::Contains(" network: cut\n"));
    CHECK_THAT(trace, Catch::Contains("[2] client -> HEL\n"));
    CHECK_THAT(trace, Catch::Contains("[2] server -> ReadResponse null, Bad_NodeIdUnknown"));
    CHECK_THAT(world().trace(1), Catch::Contains("ReadResponse") && !Catch::Contains("HEL"));
}

TEST_CASE("faults that never acted fail the test of their world", "[harness]")
{
    static std::string failures;
    const FailTest before = set_fail_test([](const std::string& why) { failures += why; });
    {
        World world{7};
        world.network().play(fault::cut().at(Message{"OPN"}));
    }
    CHECK_THAT(failures, Catch::Contains("never acted") && Catch::Contains("cut at OPN 1") &&
                             Catch::Contains("BUSBAR_SEED=7"));
    failures.clear();
    {
        World world;
        world.network().play(fault::cut().at(Message{"OPN"}));
        world.network().forgive_pending_faults();
    }
    CHECK(failures == "");
    set_fail_test(before);
}

} // namespace fault_test
