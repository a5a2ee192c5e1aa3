// Tests with a mistake each, as engineers make them: all fail, and mistakes_test.sh looks whether
// what is printed names the reason.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>

#include <stdexcept>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/harness/replay.hpp>
#include <busbar/harness/scripted_server.hpp>

namespace mistake_cases {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

class LevelBench : public BenchFixture {
public:
    NodeId level{need(add_variable("Level", 1.5))};
    NodeId limit{need(add_variable("Limit", 9.0))};
};

/// A source with a mistake.
class BrokenSensor final : public server::DataSource {
public:
    void read(server::ReadBatch /*batch*/) override
    {
        throw std::runtime_error{"sensor 7 is broken"};
    }
    void write(server::WriteBatch /*batch*/) override {}
};

/// A source that keeps its batch and never completes it.
class SleepingSensor final : public server::DataSource {
public:
    void read(server::ReadBatch batch) override { kept_.push_back(std::move(batch)); }
    void write(server::WriteBatch /*batch*/) override {}

private:
    std::vector<server::ReadBatch> kept_;
};

/// Of a client that connects and goes.
Recording recorded_session(std::uint64_t seed)
{
    World world{seed};
    const ServerHost server{world};
    const auto recorder = std::make_shared<Recorder>(seed);
    world.network().set_observer(recorder);
    ConnectionHost client{world};
    need(client.open());
    client.close();
    world.run_for(1s);
    return recorder->recording();
}

} // namespace

TEST_CASE_METHOD(BenchFixture, "a source throws")
{
    auto& sensor = make_source<BrokenSensor>();
    const NodeId level = need(add_variable("Level", sensor.variable(0, 0.0)));
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(BenchFixture, "a source never completes its batch")
{
    auto& sensor = make_source<SleepingSensor>();
    const NodeId level = need(add_variable("Level", sensor.variable(0, 0.0)));
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE("secured endpoints lack a certificate")
{
    BenchOptions options;
    options.server.endpoints = server::secure_endpoints();
    Bench bench{options};
    CHECK(bench.connect());
}

TEST_CASE_METHOD(LevelBench, "a fault of a message has a time instead")
{
    world().network().play(fault::delay(3s).after(1s));
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a fault names a message that does not exist")
{
    world().network().play(fault::cut().at(Message{"ReadReqest"}));
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a fault waits for a message that never comes")
{
    world().network().play(fault::cut().at(Message{"WriteRequest"}));
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a fault edits a field that does not exist")
{
    world().network().play(
        fault::edit("results[0].statsu", "Bad_Timeout").at(Message{"ReadResponse"}));
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a name is given twice")
{
    const NodeId again = need(add_variable("Level", 1.5));
    CHECK_THAT(read(again), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a Subscription is lost on the way")
{
    REQUIRE(subscribe(level) == status::Good);
    run_for(1s);
    world().network().cut();
    run_for(100s);
    CHECK_THAT(values(level).back(), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "the node that is looked at is not watched")
{
    REQUIRE(subscribe(level) == status::Good);
    run_for(1s);
    CHECK(values(limit).empty());
}

TEST_CASE_METHOD(LevelBench, "the interval is longer than a request may wait")
{
    REQUIRE(subscribe(level, 1h) == status::Good);
}

TEST_CASE_METHOD(LevelBench, "the least latency is above the greatest")
{
    world().network().weather().min_latency = 5ms;
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a second server has the same URL")
{
    ServerHost second{world()};
    CHECK(second.server().session_count() == 0);
}

TEST_CASE_METHOD(LevelBench, "the URL has a letter less")
{
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = "opc.tcp://sever:4840";
    CHECK(add_client("hmi", config).connect());
}

TEST_CASE_METHOD(LevelBench, "a value of another type is written")
{
    CHECK(write(level, 2) == status::Good);
}

TEST_CASE_METHOD(LevelBench, "the value never comes")
{
    CHECK_THAT(await(level, 7.0, 5s), holds(7.0));
}

TEST_CASE_METHOD(LevelBench, "an Event lacks the field that is asked for")
{
    REQUIRE(subscribe_events(NodeId{0, 2253U}, {{"Message", "Presure"}, {}, 0}) == status::Good);
}

TEST_CASE("a script that is not followed is not looked at")
{
    World world;
    ScriptedServer server{world, "opc.tcp://server:4840"};
    server.accept_clients();
    server.expect<WriteRequest>().reply(WriteResponse{});
    ConnectionHost client{world};
    CHECK(client.open());
}

TEST_CASE("a replay has another seed")
{
    const Recording recording = recorded_session(1);
    World world{7};
    const ServerHost server{world};
    Replay replay{world, recording, Side::Client};
    need(replay.run("opc.tcp://server:4840"));
    CHECK(replay.difference() == "");
}

} // namespace mistake_cases
