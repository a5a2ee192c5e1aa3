#include <array>
#include <cstring>

#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/connection_host.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/harness/scripted_client.hpp>
#include <busbar/harness/scripted_server.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/subscription.hpp>

namespace fault_message_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

constexpr const char* url = "opc.tcp://server:4840";

ReadRequest read_request(std::size_t count = 1)
{
    ReadRequest request;
    for (std::size_t i = 0; i < count; ++i) {
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = NodeId{1, static_cast<std::uint32_t>(i)};
        item.attribute_id = 13;
    }
    return request;
}

/// A client whose reads are answered with numbers from 0 on.
class Plant {
public:
    Plant()
    {
        server.accept_clients();
        server.allow<ReadRequest>().reply([this](const ReadRequest& request) {
            ReadResponse response;
            for (const ReadValueId& item : request.nodes_to_read) {
                static_cast<void>(item);
                response.results.push_back(DataValue{Variant{next_++}});
            }
            return response;
        });
        need(client.open());
    }
    void play(const Fault& fault) { world.network().play(fault); }
    Result<ReadResponse> read(std::size_t count = 1)
    {
        return client.call<ReadResponse>(read_request(count));
    }
    [[nodiscard]] std::string trace() const { return world.trace(); }

    World world;
    ScriptedServer server{world, url};
    ConnectionHost client{world};

private:
    std::int32_t next_{0};
};

const Message response{"ReadResponse"};
const Message request{"ReadRequest"};

} // namespace

TEST_CASE_METHOD(Plant, "a message that is dropped is missed, and nothing else", "[harness]")
{
    const bool is_request = GENERATE(false, true);
    play(fault::drop().at(is_request ? request : response));
    CHECK(read().error() == status::Bad_Timeout);
    CHECK_THAT(read()->results[0], holds(std::int32_t{is_request ? 0 : 1}));
    CHECK(server.report() == "");
}

TEST_CASE_METHOD(Plant, "a message arrives twice", "[harness]")
{
    SECTION("a response, which the client throws away")
    {
        play(fault::duplicate().at(response));
        CHECK_THAT(read()->results[0], holds(0));
        CHECK_THAT(read()->results[0], holds(1));
    }
    SECTION("a request, which the server does twice")
    {
        play(fault::duplicate().at(request));
        CHECK_THAT(read()->results[0], holds(0));
        CHECK_THAT(read()->results[0], holds(2));
    }
    SECTION("one of many chunks")
    {
        play(fault::duplicate().at(response));
        CHECK(read(20'000)->results.size() == 20'000);
        CHECK_THAT(read()->results[0], holds(20'000));
    }
}

TEST_CASE_METHOD(Plant, "a message is overtaken by the next one", "[harness]")
{
    play(fault::overtake().at(response));
    std::vector<std::int32_t> order;
    for (int i = 0; i < 2; ++i) {
        client.send<ReadResponse>(read_request(), [&](const Result<ReadResponse>& read) {
            order.push_back(need(read).results[0].value.value_or<std::int32_t>(-1));
        });
    }
    world.run_for(1s);
    CHECK(order == std::vector<std::int32_t>{1, 0});
    CHECK_THAT(read()->results[0], holds(2));
}

TEST_CASE_METHOD(Plant, "a field of a message is edited", "[harness]")
{
    SECTION("a status")
    {
        play(fault::edit("results[1].status", "Bad_Timeout").at(response));
        const auto answer = read(2);
        REQUIRE(answer);
        CHECK_THAT(answer->results[0], holds(0));
        CHECK(answer->results[1].status == status::Bad_Timeout);
    }
    SECTION("a value of another type")
    {
        play(fault::edit("results[0].value", "Double:1.75").at(response).times(2));
        CHECK_THAT(read()->results[0], holds(1.75));
        CHECK_THAT(read()->results[0], holds(1.75));
        CHECK_THAT(read()->results[0], holds(2));
    }
    SECTION("the header")
    {
        play(fault::edit("responseHeader.serviceResult", "Bad_TooManyOperations").at(response));
        CHECK(read().error() == status::Bad_TooManyOperations);
    }
    SECTION("a request")
    {
        play(fault::edit("nodesToRead[0].nodeId", "i=2259").at(request));
        server.expect<ReadRequest>(reads(NodeId{0, 2259U})).fail(status::Bad_NothingToDo);
        CHECK(read().error() == status::Bad_NothingToDo);
    }
    SECTION("an enumeration")
    {
        play(fault::edit("timestampsToReturn", "3").at(request));
        server.expect<ReadRequest>([](const ReadRequest& came) {
            return came.timestamps_to_return == TimestampsToReturn::Neither;
        });
        CHECK(read().error() == status::Bad_Timeout);
        CHECK(server.is_done());
    }
    SECTION("in a message of many chunks")
    {
        play(fault::edit("results[19999].status", "Bad_Timeout").at(response));
        CHECK(read(20'000)->results[19'999].status == status::Bad_Timeout);
    }
    CHECK(read());
    CHECK(server.report() == "");
}

TEST_CASE_METHOD(Plant, "an edit that cannot be says why", "[harness]")
{
    const auto [path, text, why] = GENERATE(table<const char*, const char*, const char*>(
        {{"result[0].status", "Good", "there is no field \"result[0].status\""},
         {"results[1].status", "Good", "there are only 1 elements"},
         {"results.status", "Good", "expected an index in brackets after \"results\""},
         {"results[x].status", "Good", "expected an index"},
         {"results[0]", "Good", "expected a field of \"results[0]\""},
         {"results[0].state", "Good", "there is no field \"state\" in a DataValue"},
         {"results[0].status.code", "Good", "there is nothing within \"results[0].status\""},
         {"results[0].status", "Bad_Luck", "Bad_Luck"},
         {"responseHeader.requestHandle", "-1", "expected a UInt32"}}));
    play(fault::edit(path, text).at(response));
    CHECK(read());
    CHECK_THAT(trace(), Catch::Contains("no edit " + std::string{path}) && Catch::Contains(why));
    CHECK_THAT(world.network().pending_faults(), Catch::Contains(path));
    world.network().forgive_pending_faults();
}

TEST_CASE_METHOD(Plant, "a message is cut short, or is what a test makes of it", "[harness]")
{
    play(fault::truncate(3).at(response));
    CHECK(read().error() == status::Bad_DecodingError);
    play(
        fault::change<ReadResponse>([](ReadResponse& read) { read.results.clear(); }).at(response));
    CHECK(read()->results.size() == 0);
    play(fault::change<ReadResponse>([](ReadResponse& read) {
             read.results[0].value = Variant{String{std::string(100'000, 'x')}};
         }).at(response)); // more than the client's chunks may have
    CHECK_FALSE(read());
    CHECK(client.closed_by() == status::Bad_TcpMessageTooLarge);
}

TEST_CASE_METHOD(Plant, "faults on messages need one", "[harness]")
{
    CHECK_THROWS_WITH(play(fault::drop()),
                      Catch::Contains("none is said") || Catch::Contains("neither is said"));
    CHECK_THROWS_WITH(play(fault::duplicate().at_byte(7)), Catch::Contains("none is said"));
    CHECK_THROWS_WITH(play(fault::overtake().after(response)), Catch::Contains("say at()"));
    CHECK_THROWS_WITH(play(fault::change({}).at(response)), Catch::Contains("nothing says"));
}

TEST_CASE_METHOD(Plant, "answers by faults fit in after other faults", "[harness]")
{
    const Fault first = GENERATE(fault::drop(), fault::duplicate(), fault::overtake());
    play(first.at(response));
    play(fault::answer(status::Bad_TooManyOperations).at(Message{"ReadRequest", 3}));
    int answers = 0;
    for (int i = 0; i < 4; ++i) {
        client.send<ReadResponse>(read_request(), [&](const Result<ReadResponse>&) { ++answers; });
        world.run_for(10ms);
    }
    world.run_for(1s);
    CHECK(client.is_ready());
    CHECK(answers == (first.kind == Fault::Kind::Drop ? 3 : 4));
}

TEST_CASE("a frame without a sequence number is passed on as it is", "[harness]")
{
    const Fault fault = GENERATE(fault::duplicate(), fault::overtake(), fault::drop());
    World world;
    ScriptedServer server{world, url};
    channel::ClientChannelConfig config;
    config.endpoint_url = url;
    ScriptedClient client{world, config};
    need(client.open());
    world.network().play(fault.at(Message{"MSG"}).sent_by(Side::Client).times(0));
    const std::array<char, 16> frames{'M', 'S', 'G', 'F', 8, 0, 0, 0, 'M', 'S', 'G', 'F', 8};
    client.send_bytes(std::as_bytes(std::span{frames}));
    world.run_for(1s);
    CHECK(world.network().pending_faults() == "");
}

TEST_CASE("a fault in time acts on its connection only", "[harness]")
{
    World world;
    ScriptedServer server{world, url};
    server.accept_clients();
    ConnectionHost first{world};
    ConnectionHost second{world};
    need(first.open());
    need(second.open());
    world.network().play(fault::cut().after(1s).on_connection(2));
    world.run_for(2s);
    CHECK(first.is_ready());
    CHECK_FALSE(second.is_ready());
}

TEST_CASE("a scripted client may say nothing after it has said much", "[harness]")
{
    World world;
    ScriptedServer server{world, url};
    channel::ClientChannelConfig config;
    config.endpoint_url = url;
    config.requested_lifetime = 60s;
    ScriptedClient client{world, config};
    need(client.open());
    need(client.dial());
    world.run_for(2h); // when the token would have been renewed
    REQUIRE(client.received().size() > 8);
    CHECK(std::memcmp(client.received().data(), "ERR", 3) == 0); // it says no Hello
}

/// Takes no connection.
class Full final : public Acceptor {
public:
    [[nodiscard]] bool accept(const std::shared_ptr<Link>&, std::string_view) override
    {
        return false;
    }
};

TEST_CASE("a connection that is refused does not end a recording", "[harness]")
{
    World world;
    const auto recorder = std::make_shared<Recorder>(world.seed());
    world.network().set_observer(recorder);
    Full full;
    need(world.network().listen("opc.tcp://full:4840", full));
    ScriptedServer server{world, url};
    server.accept_clients();
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = "opc.tcp://full:4840";
    ConnectionHost refused{world, config};
    CHECK_FALSE(refused.open());
    world.run_for(1s);
    ConnectionHost client{world};
    need(client.open());
    CHECK(recorder->recording().is_complete);
    CHECK(recorder->recording().entries.size() > 4);
}

} // namespace fault_message_test
