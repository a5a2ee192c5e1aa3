#include <catch2/catch.hpp>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/recording.hpp>
#include <busbar/harness/replay.hpp>
#include <busbar/server/memory_source.hpp>

namespace recording_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

constexpr const char* url = "opc.tcp://server:4840";

/// A server with a variable and a client that uses it for two seconds, written down.
class RecordedBench : public BenchFixture {
public:
    explicit RecordedBench(BenchOptions options = {}) : BenchFixture{std::move(options)}
    {
        world().network().set_observer(recorder_);
        level_ = add_variable("Level", memory_.variable(1.5)).value();
    }
    const Recording& use()
    {
        CHECK_THAT(read(level_), holds(1.5));
        CHECK(write(level_, 2.5) == status::Good);
        CHECK(subscribe(level_) == status::Good);
        run_for(2s);
        client().close();
        run_for(1s);
        return recorder_->recording();
    }

private:
    std::shared_ptr<Recorder> recorder_{std::make_shared<Recorder>(world().seed())};
    server::MemorySource& memory_{make_source<server::MemorySource>(world().clock())};
    NodeId level_;
};

/// A recording with one entry of each kind.
Recording small_recording()
{
    Recording recording;
    recording.seed = 42;
    recording.entries = {
        {Recording::Kind::Opened, 1ms, 1, Side::Client, {}},
        {Recording::Kind::Bytes, 2ms, 1, Side::Client, {std::byte{0x48}, std::byte{0xEF}}},
        {Recording::Kind::Bytes, 2ms, 1, Side::Server, {std::byte{0}}},
        {Recording::Kind::Ended, 3ms, 1, Side::Server, {}}};
    return recording;
}

constexpr std::string_view small_text = "busbar-recording 1\n"
                                        "seed 42\n"
                                        "1000000 1 open\n"
                                        "2000000 1 > 48ef\n"
                                        "2000000 1 < 00\n"
                                        "3000000 1 end server\n";

StatusCode read_status(std::string_view text, const RecordingLimits& limits = {})
{
    const auto recording = read_recording(text, limits);
    return recording ? StatusCode{} : recording.error();
}

/// What a program prints; empty if it is not there.
std::string output_of(const std::string& command)
{
    std::string text;
    if (FILE* const pipe = ::popen(command.c_str(), "r")) {
        std::array<char, 4'096> buffer{};
        while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
            text.append(buffer.data(), size);
        }
        ::pclose(pipe);
    }
    return text;
}

} // namespace

TEST_CASE("a recording is text, and read back it is the same", "[harness]")
{
    CHECK(write_recording(small_recording()) == small_text);
    const auto read = read_recording(small_text);
    REQUIRE(read);
    CHECK(*read == small_recording());
    RecordedBench bench;
    const Recording& recording = bench.use();
    CHECK(recording.entries.size() > 20);
    CHECK(recording.is_complete);
    CHECK(read_recording(write_recording(recording)).value() == recording);
}

TEST_CASE("what is no recording is refused", "[harness]")
{
    const std::string head = "busbar-recording 1\nseed 1\n";
    CHECK(read_status("") == status::Bad_DecodingError);
    CHECK(read_status("busbar-recording 2\nseed 1\n") == status::Bad_NotSupported);
    CHECK(read_status("busbar-recording 1\nseed -1\n") == status::Bad_DecodingError);
    CHECK(read_status("busbar-recording 1\nseed\n") == status::Bad_DecodingError);
    for (const char* line :
         {"1 1\n", "1 0 open\n", "1 2 open\n", "1 1 end client\n", "1 1 > 00\n", "x 1 open\n",
          "-1 1 open\n", "1 1 open x\n", "\n", "99999999999999999999 1 open\n"}) {
        CAPTURE(line);
        CHECK(read_status(head + line) == status::Bad_DecodingError);
    }
    for (const char* line : {"5 1 > 0\n", "5 1 > 0g\n", "5 1 >\n", "5 1 > 00 00\n", "4 1 > 00\n",
                             "5 1 = 00\n", "5 1 end\n", "5 1 end both\n"}) {
        CAPTURE(line);
        CHECK(read_status(head + "5 1 open\n" + line) == status::Bad_DecodingError);
    }
    // Cut anywhere it is read or refused, but never past its end.
    for (std::size_t size = 0; size < small_text.size(); ++size) {
        const auto part = read_recording(small_text.substr(0, size));
        CHECK((!part || part->entries.size() <= 4));
    }
    RecordingLimits limits;
    limits.max_entries = 3;
    CHECK(read_status(small_text, limits) == status::Bad_EncodingLimitsExceeded);
    limits = {};
    limits.max_bytes = 2;
    CHECK(read_status(small_text, limits) == status::Bad_EncodingLimitsExceeded);
    limits = {};
    limits.max_connections = 0;
    CHECK(read_status(small_text, limits) == status::Bad_EncodingLimitsExceeded);
}

TEST_CASE_METHOD(BenchFixture, "a recorder stops at its limits and says so", "[harness]")
{
    RecordingLimits limits;
    limits.max_bytes = 100;
    const auto recorder = std::make_shared<Recorder>(world().seed(), limits);
    world().network().set_observer(recorder);
    REQUIRE(connect());
    CHECK_FALSE(recorder->recording().is_complete);
    CHECK(recorder->recording().stream(1, Side::Client).size() <= 100);
}

TEST_CASE_METHOD(BenchFixture, "a recorder and a replay take what they are made for", "[harness]")
{
    RecordingLimits limits;
    limits.max_connections = 1;
    const auto recorder = std::make_shared<Recorder>(world().seed(), limits);
    world().network().set_observer(recorder);
    REQUIRE(connect());
    CHECK(recorder->recording().is_complete);
    const std::size_t first = recorder->recording().stream(1, Side::Client).size();
    REQUIRE(client("another").connect());
    CHECK_FALSE(recorder->recording().is_complete);
    CHECK(recorder->recording().stream(1, Side::Client).size() == first);
    CHECK(recorder->recording().stream(2, Side::Client).empty());

    // Nobody is there, or comes to one that plays a client.
    const Recording recording = small_recording();
    Replay replay{world(), recording, Side::Client};
    CHECK(replay.run("opc.tcp://nobody:1").error() == status::Bad_ConnectionRejected);
    REQUIRE(world().network().listen("opc.tcp://replay:1", replay));
    client::ConnectionConfig config = open_connection_config();
    config.channel.endpoint_url = "opc.tcp://replay:1";
    CHECK(ConnectionHost{world(), config}.open().error() == status::Bad_ConnectionRejected);
    // Its server has another answer than the one byte that was recorded.
    REQUIRE(replay.run(url));
    CHECK_FALSE(replay.is_over());
}

TEST_CASE("a replayed client gets byte for byte what the recorded one got", "[harness]")
{
    RecordedBench recorded;
    const Recording recording = recorded.use();

    BenchOptions options;
    options.seed = recording.seed;
    RecordedBench bench{options};
    Replay replay{bench.world(), recording, Side::Client};
    REQUIRE(replay.run(url));
    CHECK(replay.difference() == "");
    CHECK(replay.is_over());
}

TEST_CASE("a replay tells what is different", "[harness]")
{
    RecordedBench recorded;
    const Recording recording = recorded.use();

    BenchOptions options;
    options.seed = recording.seed;
    BenchFixture bench{options}; // without the variable
    Replay replay{bench.world(), recording, Side::Client};
    REQUIRE(replay.run(url));
    CHECK_THAT(replay.difference(),
               Catch::Contains("another byte at frame") && Catch::Contains("MSG ReadResponse"));
}

TEST_CASE("a replayed server hears byte for byte what the recorded one heard", "[harness]")
{
    RecordedBench recorded;
    const Recording recording = recorded.use();

    World world{recording.seed};
    Replay replay{world, recording, Side::Server};
    REQUIRE(world.network().listen(url, replay));
    ConnectionHost client{world};
    REQUIRE(client.open());
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Both;
    ReadValueId& item = request.nodes_to_read.emplace_back();
    item.node_id = NodeId{1, "Level"};
    item.attribute_id = 13;
    const auto response = client.call<ReadResponse>(std::move(request));
    REQUIRE(response);
    CHECK_THAT(response->results[0], holds(1.5));
    CHECK(replay.difference() == "");
    CHECK_FALSE(replay.is_over());
}

TEST_CASE_METHOD(BenchFixture, "a replay says that its world has another seed", "[harness]")
{
    const auto recorder = std::make_shared<Recorder>(world().seed());
    world().network().set_observer(recorder);
    REQUIRE(connect());
    client().close();
    const Recording recording = recorder->recording();
    World again{recording.seed + 1};
    const ServerHost server{again};
    Replay replay{again, recording, Side::Client};
    REQUIRE(replay.run(url));
    CHECK_THAT(replay.difference(),
               Catch::Contains("the recording has the seed " + std::to_string(recording.seed) +
                               ", the world " + std::to_string(recording.seed + 1)));
}

TEST_CASE_METHOD(BenchFixture, "a replay plays the connection that it is told to", "[harness]")
{
    const auto recorder = std::make_shared<Recorder>(world().seed());
    world().network().set_observer(recorder);
    REQUIRE(connect());
    REQUIRE(client("second").connect());
    world().network().set_observer(nullptr);
    client().drop();
    client("second").host().drop();
    const Recording recording = recorder->recording();

    // Each end in a world of its own: what the other sends of another connection does not fit.
    World again{recording.seed};
    Replay played{again, recording, Side::Server, 2};
    REQUIRE(again.network().listen(url, played));
    Replay same{again, recording, Side::Client, 2};
    REQUIRE(same.run(url));
    CHECK(same.difference() == "");
    CHECK(same.is_over());
    CHECK(played.difference() == "");
    CHECK(played.is_over());
    World third{recording.seed};
    Replay other{third, recording, Side::Server, 1};
    REQUIRE(third.network().listen(url, other));
    Replay wrong{third, recording, Side::Client, 2};
    REQUIRE(wrong.run(url));
    CHECK_THAT(wrong.difference(), Catch::StartsWith("another byte at frame "));
    // A second client is not let in while there is one.
    Replay late{again, recording, Side::Client, 2};
    CHECK(late.run(url).error() == status::Bad_ConnectionRejected);
}

TEST_CASE("tshark decodes a capture as OPC UA", "[harness]")
{
    RecordedBench bench;
    const auto bytes = to_pcap(bench.use());
    const std::filesystem::path file =
        std::filesystem::path{BUSBAR_BINARY_DIR} / "harness_test.pcap";
    std::ofstream{file, std::ios::binary}.write(reinterpret_cast<const char*>(bytes.data()),
                                                static_cast<std::streamsize>(bytes.size()));
    if (output_of("tshark --version 2>&1").find("TShark") == std::string::npos) {
        WARN("left out: tshark is not installed");
        return;
    }
    const std::string types = output_of(
        "tshark -r " + file.string() +
        " -o ip.check_checksum:TRUE -o tcp.check_checksum:TRUE -d tcp.port==4840,opcua -T fields"
        " -e opcua.transport.type -e _ws.malformed -e _ws.expert.message -e ip.checksum.status"
        " -e tcp.checksum.status 2>&1");
    for (const char* type : {"HEL", "ACK", "OPN", "MSG", "CLO"}) {
        CHECK_THAT(types, Catch::Contains(type));
    }
    CHECK_THAT(types, !Catch::Contains("alformed"));
    CHECK_THAT(types, !Catch::Contains("ncorrect"));
    CHECK_THAT(types, !Catch::Contains("etransmission") && !Catch::Contains("not captured"));
    CHECK_THAT(types, Catch::Contains("1\t1\n") && !Catch::Contains("\t0\n")); // 1 is good
    std::filesystem::remove(file);
}

} // namespace recording_test
