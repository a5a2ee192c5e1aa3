#include <busbar/backend/device_protocols.hpp>

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/status_codes.hpp>
#include <busbar/harness/slmp_responder.hpp>

#include "device_line.hpp"

namespace slmp_device_test {

// A Device before simulated PLCs of the families that speak SLMP, in virtual time.

using namespace busbar;
using namespace busbar::backend;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

const StatusCode good{};

std::vector<DevicePoint> points_of(const std::vector<std::string>& texts,
                                   const SlmpProtocolOptions& options = {})
{
    std::vector<DevicePoint> points;
    for (const std::string& text : texts) {
        const auto point = parse_slmp_point(text, options);
        REQUIRE(point);
        points.push_back(*point);
    }
    return points;
}

/// A PLC whose devices have their number as value, bits whether it is odd, and a device before it.
class Plant {
public:
    explicit Plant(const std::vector<std::string>& texts, SlmpPlcOptions of_plc = {},
                   const SlmpProtocolOptions& options = {})
        : plc{std::move(of_plc)}, points{points_of(texts, options)}, line{{.name = "mixer"},
                                                                          make_slmp_protocol(
                                                                              options, points)}
    {
        for (const char* const kind : {"D", "W", "SD"}) {
            REQUIRE(plc.add_devices(kind, 2'048));
        }
        REQUIRE(plc.add_devices("M", 2'048));
        REQUIRE(plc.add_devices("X", 2'048));
        REQUIRE(plc.add_devices("LZ", 2));
        for (std::uint32_t i = 0; i < 2'048; ++i) {
            const std::string number = std::to_string(i);
            REQUIRE(plc.set("D" + number, static_cast<std::uint16_t>(i)));
            REQUIRE(plc.set("M" + number, i % 2));
        }
        plc.set("LZ1", 0x1234, 0);
        plc.set("LZ1", 0x5678, 1);
        for (const DevicePoint& point : points) {
            addresses.push_back(point.address);
        }
    }

    void connect()
    {
        line.connect(plc);
        INFO(line.device.trouble());
        REQUIRE(line.device.state() == DeviceState::Online);
    }
    /// Requests that the last call took.
    [[nodiscard]] std::uint64_t asked()
    {
        const auto now = plc.served();
        return now - std::exchange(before, now);
    }

    SlmpResponder plc;
    std::vector<DevicePoint> points;
    test::Line<SlmpResponder> line;
    std::vector<PlanAddress> addresses;
    std::uint64_t before{0};
};

const std::vector<std::string> scattered{"D1",  "D100:int32", "D300", "M17",  "M18",  "M31",
                                         "M40", "M1000",      "LZ1",  "D500", "D700", "D900"};
const std::vector<std::uint16_t> their_words{1, 100, 101,    300,    1,   0,   1,
                                             0, 0,   0x1234, 0x5678, 500, 700, 900};

} // namespace

TEST_CASE("scattered words, double words and bits of a PLC come with one request")
{
    Plant plant{scattered};
    plant.connect();
    static_cast<void>(plant.asked());
    CHECK(plant.line.read(plant.addresses) == std::vector<StatusCode>(scattered.size(), good));
    CHECK(plant.line.words == their_words);
    CHECK(plant.asked() == 1);
}

TEST_CASE("a PLC without random or block reads has the same values, and is not asked again")
{
    const bool has_random = GENERATE(false, true);
    const bool has_blocks = GENERATE(false, true);
    const bool is_long = GENERATE(false, true);
    INFO(has_random << has_blocks << is_long);
    SlmpPlcOptions options;
    options.has_random = has_random;
    options.has_blocks = has_blocks;
    options.takes_long_form = is_long;
    std::vector<std::string> texts;
    std::vector<std::uint16_t> words;
    // 70 words, 25 apart, and two texts that are too long for a list.
    for (std::uint32_t i = 0; i < 70; ++i) {
        texts.push_back("D" + std::to_string(i * 25));
        words.push_back(static_cast<std::uint16_t>(i * 25));
    }
    texts.insert(texts.end(), {"W100:text200", "W400:text200", "M5"});
    words.resize(words.size() + 200);
    words.push_back(1);
    Plant plant{texts, options};
    plant.connect();
    static_cast<void>(plant.asked());
    CHECK(plant.line.read(plant.addresses) == std::vector<StatusCode>(texts.size(), good));
    CHECK(plant.line.words == words);
    static_cast<void>(plant.asked());
    CHECK(plant.line.read(plant.addresses) == std::vector<StatusCode>(texts.size(), good));
    CHECK(plant.line.words == words);
    const std::uint64_t asked = plant.asked();
    CHECK(plant.line.device.counters().failures == 0);
    if (has_random && has_blocks) {
        CHECK(asked <= 4);
    } else if (has_random || has_blocks) {
        CHECK(asked <= 6);
    } else {
        // A gap of 24 words costs less than a request.
        CHECK(asked <= 8);
    }
}

TEST_CASE("as many random points are asked for as a PLC takes, in each form")
{
    const bool is_long = GENERATE(false, true);
    SlmpPlcOptions options;
    options.has_blocks = false;
    options.takes_long_form = is_long;
    std::vector<std::string> texts;
    for (std::uint32_t i = 0; i < 192; ++i) {
        texts.push_back("D" + std::to_string(i * 10));
    }
    SlmpProtocolOptions of_it = slmp_options(is_long ? SlmpFamily::IqR : SlmpFamily::Q);
    if (!is_long) {
        options.takes_4e = false;
        options.has_type_name = false;
        of_it.client.frame = SlmpFrame::Frame3E;
    }
    Plant plant{texts, options, of_it};
    plant.connect();
    static_cast<void>(plant.asked());
    CHECK(plant.line.read(plant.addresses) == std::vector<StatusCode>(192, good));
    CHECK(plant.asked() == (is_long ? 2 : 1));
    CHECK(plant.line.device.counters().refusals == 0);
}

TEST_CASE("scattered writes go together: words as a list or blocks, bits as a list")
{
    const bool has_random = GENERATE(false, true);
    const bool has_blocks = GENERATE(false, true);
    SlmpPlcOptions options;
    options.has_random = has_random;
    options.has_blocks = has_blocks;
    std::vector<std::string> texts;
    std::vector<std::vector<std::uint16_t>> values;
    for (std::uint16_t i = 0; i < 90; ++i) {
        texts.push_back("D" + std::to_string(i * 20));
        values.push_back({static_cast<std::uint16_t>(i + 7'000)});
    }
    for (std::uint16_t i = 0; i < 100; ++i) {
        texts.push_back("M" + std::to_string(i * 3));
        values.push_back({static_cast<std::uint16_t>(i % 3 == 0)});
    }
    Plant plant{texts, options};
    plant.connect();
    static_cast<void>(plant.asked());
    CHECK(plant.line.write(plant.addresses, values) == std::vector<StatusCode>(190, good));
    const std::uint64_t asked = plant.asked();
    // What it does not have is refused in both forms. The words are 60 blocks and the rest.
    CHECK(asked == (has_random ? 2 + 2 : has_blocks ? 2 + 3 + 100 : 2 + 2 + 190));
    for (std::size_t i = 0; i < texts.size(); ++i) {
        CHECK(plant.plc.get(texts[i]) == values[i].front());
    }
    CHECK(plant.plc.get("D21") == 21);
    CHECK(plant.plc.get("M1") == 1);
}

TEST_CASE("one device that a PLC refuses among many is found, and told by its end code")
{
    Plant plant{scattered};
    plant.connect();
    REQUIRE(plant.plc.refuse("D500", 0x4031));
    const auto statuses = plant.line.read(plant.addresses);
    for (std::size_t i = 0; i < scattered.size(); ++i) {
        CHECK(statuses[i].is_bad() == (scattered[i] == "D500"));
    }
    CHECK(plant.line.device.last_refusal().find("4031: ") == 0);
    CHECK(plant.line.device.last_refusal().find("outside the range") != std::string::npos);
}

TEST_CASE("RUN and STOP are read from the PLC with its values")
{
    Plant plant{scattered};
    plant.connect();
    const auto place = plant.line.device.protocol().mode_place();
    REQUIRE(place);
    const auto mode = [&] {
        auto addresses = plant.addresses;
        addresses.push_back(*place);
        static_cast<void>(plant.asked());
        CHECK(plant.line.read(addresses).back() == good);
        CHECK(plant.asked() == 1);
        return plant.line.device.protocol().mode_of(std::span{plant.line.words}.last(1));
    };
    CHECK(mode() == DeviceMode::Run);
    plant.plc.set_running(false);
    CHECK(mode() == DeviceMode::Stop);
    plant.plc.set_running(true);
    CHECK(mode() == DeviceMode::Run);
}

TEST_CASE("auto finds out what a PLC is, and X and Y have to be told")
{
    const SlmpProtocolOptions found = slmp_options(SlmpFamily::Auto);
    CHECK(parse_slmp_point("X7", found));
    const auto refused = parse_slmp_point("X10", found);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().where == "column 2");
    CHECK(refused.error().text.find("octal for FX5") != std::string::npos);
    CHECK(parse_slmp_point("X10", slmp_options(SlmpFamily::Fx5))->address.offset == 8);
    CHECK(parse_slmp_point("X10", slmp_options(SlmpFamily::IqR))->address.offset == 16);

    SlmpPlcOptions fx5{.type_name = "FX5U-32MT/DS", .takes_long_form = false, .is_fx5 = true};
    fx5.latency = 5ms;
    SlmpProtocolOptions many = found;
    many.client.max_under_way = 8;
    std::vector<std::string> texts;
    for (std::uint32_t i = 0; i < 1'900; i += 9) {
        texts.push_back("D" + std::to_string(i));
    }
    // Of two requests at a time this PLC would answer only one.
    Plant plant{texts, fx5, many};
    plant.line.connect(plant.plc);
    plant.line.advance(10ms);
    REQUIRE(plant.line.device.state() == DeviceState::Online);
    CHECK(plant.line.device.identity().product == "FX5U-32MT/DS");
    REQUIRE(plant.line.device.read(plant.addresses, plant.line.now));
    plant.line.move();
    plant.line.advance(1s);
    CHECK(plant.line.statuses() == std::vector<StatusCode>(texts.size(), good));
}

TEST_CASE("a PLC in which X and Y are other ones than configured is not read")
{
    SlmpPlcOptions fx5{.type_name = "FX5U-32MT/DS", .takes_long_form = false, .is_fx5 = true};
    Plant plant{{"X10", "D1"}, fx5};
    plant.line.connect(plant.plc);
    CHECK(plant.line.device.state() == DeviceState::Waiting);
    CHECK(plant.line.device.trouble().find("X and Y are octal: set family = \"fx5\"") !=
          std::string::npos);
    Plant other{{"D1"}, fx5};
    other.connect();
    CHECK(other.line.read(other.addresses) == std::vector<StatusCode>{good});
}

TEST_CASE("a remote password opens the port, and a wrong one is not tried over and over")
{
    SlmpProtocolOptions options;
    options.password = "secret1";
    Plant plant{{"D5"}, {.password = "secret1"}, options};
    plant.connect();
    CHECK(plant.line.read(plant.addresses) == std::vector<StatusCode>{good});
    // The port is locked again on the next connection.
    plant.line.cut("gone");
    plant.line.now = plant.line.device.next_deadline();
    plant.plc.reconnect();
    plant.connect();
    CHECK(plant.line.read(plant.addresses) == std::vector<StatusCode>{good});

    Plant wrong{{"D5"}, {.password = "another"}, options};
    Duration pause{0};
    for (int i = 0; i < 8; ++i) {
        wrong.line.connect(wrong.plc);
        CHECK(wrong.line.device.state() == DeviceState::Waiting);
        CHECK(wrong.line.device.trouble() ==
              "C810: the remote password is wrong; it is tried again after 10 minutes, or at a "
              "restart");
        pause = wrong.line.device.next_deadline() - wrong.line.now;
        wrong.line.now = wrong.line.device.next_deadline();
        wrong.plc.reconnect();
    }
    CHECK(pause >= 10min);
    CHECK(wrong.line.log.text().find("secret1") == std::string::npos);

    Plant without{{"D5"}, {.password = "another"}};
    without.line.connect(without.plc);
    CHECK(without.line.device.trouble() == "C201: the port is locked by a remote password");
}

} // namespace slmp_device_test
