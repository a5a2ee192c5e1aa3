#include <busbar/harness/slmp_responder.hpp>

#include <catch2/catch.hpp>

#include <busbar/backend/slmp_client.hpp>

#include "backend/slmp/slmp_vectors.hpp"

namespace slmp_responder_test {

using namespace busbar;
using namespace busbar::backend;
using namespace busbar::harness;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::uint16_t code_d = 0xA8;

/// A PLC that is in the state in which a row's response comes from its request.
SlmpResponder plc_for(const Json& row)
{
    const auto name = row["name"].get<std::string>();
    const Json& response = row["response_fields"];
    SlmpPlcOptions options;
    options.is_fx5 = name.find("FX5U") != std::string::npos;
    options.has_monitor = !options.is_fx5;
    options.takes_mixed_blocks = name == "block write two blocks";
    options.is_written_in_run = name.find("while running is disabled") == std::string::npos;
    if (name.find("locked port") == 0 || name.find("password") != std::string::npos) {
        options.password = "secret1";
    }
    if (!response.is_null() && response.contains("model")) {
        options.type_name = response["model"].get<std::string>();
        options.model = code_of(response["model_code"]);
    }
    SlmpResponder plc{options};
    for (const auto& [kind, count] :
         std::initializer_list<std::pair<const char*, std::uint32_t>>{{"D", 12288},
                                                                      {"M", 8192},
                                                                      {"X", 8192},
                                                                      {"Y", 8192},
                                                                      {"W", 8192},
                                                                      {"B", 8192},
                                                                      {"R", 32768},
                                                                      {"Z", 20},
                                                                      {"TN", 1024},
                                                                      {"LTN", 1024},
                                                                      {"RD", 524288},
                                                                      {"U1\\G", 100},
                                                                      {"U3E0\\G", 100}}) {
        REQUIRE(plc.add_devices(kind, count));
    }
    const bool has_4e_zr = row["frame"] == "4E";
    REQUIRE(plc.add_devices("ZR", has_4e_zr ? 1'536'000 : 393'216));
    return plc;
}

std::vector<std::byte> say_to(SlmpResponder& plc, std::span<const std::byte> request)
{
    plc.feed(request, TimePoint{});
    std::vector<std::byte> answer;
    while (!plc.output().empty()) {
        const auto output = plc.output();
        answer.insert(answer.end(), output.begin(), output.end());
        plc.consume(output.size());
    }
    return answer;
}

/// Has the PLC hold what the row reads, by a write of the same devices or labels.
void prepare(SlmpResponder& plc, const Json& row, SlmpOperation operation)
{
    using enum SlmpCommand;
    const auto answer = answer_of(row["response_fields"]);
    if (answer.end_code != 0) {
        return;
    }
    SlmpOperation write = operation;
    write.words = answer.words;
    switch (operation.command) {
    case BatchRead:
        write.command = BatchWrite;
        break;
    case RandomRead:
    case ReadMonitor:
        write.command = RandomWrite;
        break;
    case LabelArrayRead:
    case LabelRandomRead:
    case LabelArrayWrite:
    case LabelRandomWrite: {
        const Json& values =
            operation.command == LabelArrayRead || operation.command == LabelRandomRead
                ? row["response_fields"]["labels"]
                : row["request_fields"]["labels"];
        for (std::size_t i = 0; i < operation.labels.size(); ++i) {
            const Json& value = values[i];
            const auto type = value["type"].get<std::uint8_t>();
            auto data = bytes_of(value["data"]);
            std::size_t size = value["length"].get<std::size_t>();
            if (type == 1) {
                const std::size_t bits = operation.labels[i].is_in_bits ? size : 1;
                std::vector<std::byte> single(bits);
                for (std::size_t bit = 0; bit < bits; ++bit) {
                    single[bit] = (data[bit / 8] >> (bit % 8)) & std::byte{1};
                }
                data = single;
                size = 1;
            }
            const Json& names = row["request_fields"]["labels"][i];
            plc.add_label(names.value("full", operation.labels[i].name), type, data, size);
        }
        return;
    }
    default:
        return;
    }
    if (operation.command == ReadMonitor) {
        SlmpOperation registration = operation;
        registration.command = RegisterMonitor;
        REQUIRE(say_to(plc, *encode_slmp_request({}, 16, registration)).size() == 11);
    }
    REQUIRE(say_to(plc, *encode_slmp_request({}, 16, write)).size() == 11);
}

/// A client and a PLC in virtual time; what one says the other one hears at once.
class Fixture {
public:
    explicit Fixture(SlmpClientOptions client_options = {.max_under_way = 4},
                     SlmpPlcOptions plc_options = {})
        : client{client_options}, plc{std::move(plc_options)}
    {
        REQUIRE(plc.add_devices("D", 1000));
        REQUIRE(plc.add_devices("M", 1000));
    }

    void exchange()
    {
        while (!client.output().empty() || !plc.output().empty()) {
            const auto request = client.output();
            plc.feed(request, now);
            client.consume(request.size());
            const auto answer = plc.output();
            if (!answer.empty()) {
                static_cast<void>(client.feed(answer, now));
                plc.consume(answer.size());
            }
        }
        if (plc.is_closed()) {
            client.close(status::Bad_ConnectionClosed, "the test ends it");
        }
    }
    SlmpEvent ask(const SlmpOperation& operation)
    {
        const auto id = client.send(operation, now);
        REQUIRE(id);
        exchange();
        for (int turn = 0; turn < 10; ++turn) {
            if (auto event = client.next_event()) {
                CHECK(event->id == *id);
                return std::move(*event);
            }
            now = std::min(client.next_deadline(), plc.next_deadline());
            plc.handle_deadline(now);
            exchange();
            client.handle_deadline(now);
        }
        FAIL("no answer");
        return {};
    }

    TimePoint now{};
    SlmpClient client;
    SlmpResponder plc;
};

SlmpOperation read_d(std::uint32_t number, std::uint16_t points = 1)
{
    return {.command = SlmpCommand::BatchRead, .blocks = {{{code_d, number}, points}}};
}

SlmpOperation write_d(std::uint32_t number, std::vector<std::uint16_t> words)
{
    return {.command = SlmpCommand::BatchWrite,
            .blocks = {{{code_d, number}, static_cast<std::uint16_t>(words.size())}},
            .words = std::move(words)};
}

} // namespace

TEST_CASE("the simulated PLC answers as PLCs, manuals and other implementations do", "[vectors]")
{
    std::size_t count = 0;
    for (const Json& row : slmp_rows("slmp-frames.jsonl")) {
        if (row["response"].is_null()) {
            continue;
        }
        INFO(row["name"]);
        SlmpResponder plc = plc_for(row);
        if (row["request_fields"].contains("password") &&
            row["response_fields"]["end_code"] == "0000") {
            // Any password opens a port that has none.
            plc = SlmpResponder{};
        }
        if (row["command"] != "9999") {
            prepare(plc, row,
                    operation_of(code_of(row["command"]), code_of(row["subcommand"]),
                                 row["request_fields"]));
        }
        CHECK(hex_of(say_to(plc, bytes_of(row["request"]))) == row["response"].get<std::string>());
        ++count;
    }
    CHECK(count == 63);
}

TEST_CASE("a client gets from the simulated PLC what is in its captures", "[vectors]")
{
    for (const Json& row : slmp_rows("slmp-frames.jsonl")) {
        if (row["response"].is_null() || row["command"] == "9999") {
            continue;
        }
        INFO(row["name"]);
        SlmpClient client{{.frame = row["frame"] == "4E" ? SlmpFrame::Frame4E : SlmpFrame::Frame3E,
                           .station = station_of(row),
                           .timer = row["timer"].get<std::uint16_t>()}};
        const auto operation = operation_of(code_of(row["command"]), code_of(row["subcommand"]),
                                            row["request_fields"]);
        REQUIRE(client.send(operation, TimePoint{}));
        auto expected = bytes_of(row["request"]);
        auto response = bytes_of(row["response"]);
        if (row["frame"] == "4E") {
            // The client counts its serial numbers from 1.
            expected[2] = response[2] = std::byte{1};
            expected[3] = response[3] = std::byte{0};
        }
        CHECK(hex_of(client.output()) == hex_of(expected));
        client.consume(client.output().size());
        for (const std::byte byte : response) {
            CHECK(client.feed({&byte, 1}, TimePoint{}));
        }
        const auto event = client.next_event();
        REQUIRE(event);
        CHECK(event->status.is_good());
        CHECK(event->answer == answer_of(row["response_fields"]));
    }
}

TEST_CASE("a client reads back from the simulated PLC what it has written")
{
    const auto frame = GENERATE(SlmpFrame::Frame3E, SlmpFrame::Frame4E);
    const bool is_datagram = GENERATE(false, true);
    Fixture world{{.frame = frame, .is_datagram = is_datagram, .max_under_way = 2},
                  {.is_datagram = is_datagram, .latency = 10ms}};
    CHECK(world.ask(write_d(100, {1, 2, 3})).answer.end_code == 0);
    CHECK(world.plc.get("D101") == 2);
    const auto read = world.ask(read_d(99, 5));
    CHECK(read.answer.words == std::vector<std::uint16_t>{0, 1, 2, 3, 0});
    CHECK(read.round_trip == 10ms);
    CHECK(world.plc.set("M17", 1));
    CHECK(
        world.ask({.command = SlmpCommand::BatchRead, .blocks = {{{0x90, 16}, 1}}}).answer.words ==
        std::vector<std::uint16_t>{2});
    CHECK(world.ask(read_d(999, 2)).answer.end_code == 0x4031);
    CHECK(world.ask(read_d(0, 961)).answer.end_code == 0xC051);
    // A write that is refused in part has no effect at all.
    const SlmpOperation both{.command = SlmpCommand::RandomWrite,
                             .blocks = {{{code_d, 5}}, {{code_d, 1000}}},
                             .words = {7, 7}};
    CHECK(world.ask(both).answer.end_code == 0x4031);
    CHECK(world.plc.get("D5") == 0);
}

TEST_CASE("the simulated PLC can be locked, stopped and reset")
{
    Fixture world{{}, {.is_written_in_run = false, .password = "secret"}};
    CHECK(world.ask(read_d(1)).answer.end_code == 0xC201);
    CHECK(world.ask({.command = SlmpCommand::Unlock, .text = "guess"}).answer.end_code == 0xC810);
    CHECK(world.ask({.command = SlmpCommand::Unlock, .text = "secret"}).answer.end_code == 0);
    CHECK(world.ask(read_d(1)).answer.end_code == 0);
    CHECK(world.ask(write_d(1, {1})).answer.end_code == 0x0055);
    CHECK(world.ask({.command = SlmpCommand::RemoteReset}).answer.end_code == 0x4013);
    CHECK(world.ask({.command = SlmpCommand::RemoteStop}).answer.end_code == 0);
    CHECK_FALSE(world.plc.is_running());
    CHECK(world.ask(write_d(1, {1})).answer.end_code == 0);
    CHECK(world.ask({.command = SlmpCommand::RemoteReset}).status.is_good());
    CHECK(world.client.is_closed());
    world.plc.reconnect();
    world.client = SlmpClient{{}};
    CHECK(world.ask(read_d(1)).answer.end_code == 0xC201);
    CHECK(world.plc.get("D1") == 1);
}

TEST_CASE("no mishap of a PLC is taken for a value")
{
    const auto frame = GENERATE(SlmpFrame::Frame3E, SlmpFrame::Frame4E);
    const auto mishap = GENERATE(SlmpMishap::Refused, SlmpMishap::Silent, SlmpMishap::Twice,
                                 SlmpMishap::WrongSerial, SlmpMishap::TooShort, SlmpMishap::CutOff,
                                 SlmpMishap::Closed);
    INFO(static_cast<int>(frame) << " " << static_cast<int>(mishap));
    Fixture world{{.frame = frame}};
    CHECK(world.plc.set("D1", 11));
    CHECK(world.plc.set("D2", 22));
    world.plc.happen(mishap, 1, 0xC059);
    const auto first = world.ask(read_d(1));
    if (mishap == SlmpMishap::Twice) {
        CHECK(first.answer.words == std::vector<std::uint16_t>{11});
    } else if (mishap == SlmpMishap::Refused) {
        CHECK(first.answer.end_code == 0xC059);
    } else {
        CHECK(first.status.is_bad());
        CHECK(first.answer.words.empty());
    }
    if (world.client.is_closed()) {
        CHECK(world.client.next_event()->kind == SlmpEvent::Kind::Closed);
        world.client = SlmpClient{{.frame = frame}};
        world.plc.reconnect();
    }
    CHECK(world.ask(read_d(2)).answer.words == std::vector<std::uint16_t>{22});
    CHECK(world.plc.served() == 2);
}

TEST_CASE("a PLC with 3E only does not answer 4E at all, and one with labels forgets none")
{
    Fixture world{{}, {.takes_4e = false}};
    CHECK(world.ask(read_d(1)).status == StatusCode{status::Bad_Timeout});
    CHECK(world.plc.served() == 0);

    Fixture other;
    const std::array value{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}};
    other.plc.add_label("Counts", 2, value, 2);
    const auto read = other.ask(
        {.command = SlmpCommand::LabelRandomRead, .labels = {{"counts[1]"}, {"COUNTS[h0]"}}});
    REQUIRE(read.answer.labels.size() == 2);
    CHECK(hex_of(read.answer.labels[0].data) == "0304");
    CHECK(hex_of(read.answer.labels[1].data) == "0102");
    for (const char* const name : {"Counts[2]", "Counts[x]", "Counts[", "%1", "%0.a", "Other"}) {
        CHECK(other.ask({.command = SlmpCommand::LabelRandomRead, .labels = {{name}}})
                  .answer.end_code == 0x40C0);
    }
    CHECK(other.ask({.command = SlmpCommand::LabelArrayRead, .labels = {{"Counts[1]", false, 4}}})
              .answer.end_code == 0xC05C);
    other.plc.clear_labels();
    CHECK(other.ask({.command = SlmpCommand::LabelRandomRead, .labels = {{"counts[1]"}}})
              .answer.end_code == 0x40C0);
}

TEST_CASE("a PLC refuses requests for single devices, of words and of bits")
{
    Fixture world;
    CHECK(world.plc.refuse("D300", 0x4031));
    CHECK(world.plc.refuse("M20", 0xC05B));
    CHECK_FALSE(world.plc.refuse("Q1", 0xC05B));
    CHECK(world.ask(read_d(299)).answer.end_code == 0);
    CHECK(world.ask(read_d(299, 2)).answer.end_code == 0x4031);
    CHECK(world.ask(read_d(301)).answer.end_code == 0);
    CHECK(world.ask(write_d(300, {1})).answer.end_code == 0x4031);
    CHECK(world.plc.get("D300") == 0);
    const auto read_m = [&](std::uint32_t number, std::uint16_t points, bool is_bits) {
        return world
            .ask({.command = SlmpCommand::BatchRead,
                  .is_bits = is_bits,
                  .blocks = {{{0x90, number}, points}}})
            .answer.end_code;
    };
    CHECK(read_m(10, 10, true) == 0);
    CHECK(read_m(10, 11, true) == 0xC05B);
    CHECK(read_m(5, 1, false) == 0xC05B);
    world.plc.refuse_none();
    CHECK(read_m(10, 11, true) == 0);
}

TEST_CASE("connections to one PLC share its devices, but not its lock")
{
    Fixture world{{}, {.has_type_name = false, .password = "secret"}};
    SlmpResponder other = world.plc.another_connection();
    CHECK(world.ask({.command = SlmpCommand::Unlock, .text = "secret"}).answer.end_code == 0);
    CHECK(world.ask(write_d(1, {7})).answer.end_code == 0);
    CHECK(world.ask({.command = SlmpCommand::TypeName}).answer.end_code == 0xC059);
    CHECK(other.get("D1") == 7);
    CHECK(other.served() == 3);
    std::swap(world.plc, other);
    CHECK(world.ask(read_d(1)).answer.end_code == 0xC201);
    world.plc.set_latency(20ms);
    CHECK(other.next_deadline() == no_deadline);
    const auto before = world.now;
    CHECK(world.ask({.command = SlmpCommand::Unlock, .text = "secret"}).round_trip == 20ms);
    CHECK(world.now == before + 20ms);
    CHECK(world.ask(read_d(1)).answer.words == std::vector<std::uint16_t>{7});
}

} // namespace slmp_responder_test
