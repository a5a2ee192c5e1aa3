#include <busbar/backend/device_protocols.hpp>

#include <optional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/status_codes.hpp>
#include <busbar/harness/modbus_responder.hpp>
#include <busbar/harness/slmp_responder.hpp>

#include "device_line.hpp"

namespace device_fault_test {

// What goes wrong on a PLC's side, seen by who reads its values: a value is the PLC's or has a bad
// status, and after the fault everything is read again.

using namespace busbar;
using namespace busbar::backend;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t apart = 200;
constexpr std::size_t count = 4;

/// Connects, or waits until it may and connects then. `renewed` returns the PLC's end of another
/// connection.
template <typename Line, typename Renewed>
void connect(Line& line, const Renewed& renewed)
{
    for (int i = 0; i < 8 && line.device.state() != DeviceState::Online; ++i) {
        line.now = std::max(line.now, line.device.next_deadline());
        line.connect(renewed());
        line.advance(6s);
    }
    REQUIRE(line.device.state() == DeviceState::Online);
}

/// Each value is that of its place, or bad. Returns how many are good.
std::size_t check_values(const std::vector<StatusCode>& statuses,
                         const std::vector<std::uint16_t>& words)
{
    REQUIRE(statuses.size() == count);
    REQUIRE(words.size() == count);
    std::size_t good = 0;
    for (std::size_t i = 0; i < count; ++i) {
        CHECK(words[i] == (statuses[i].is_good() ? 10 + i * apart : 0));
        good += statuses[i].is_good() ? 1U : 0U;
    }
    return good;
}

template <typename Line>
std::size_t read_through(Line& line, const std::vector<PlanAddress>& addresses)
{
    REQUIRE(line.device.read(addresses, line.now));
    line.move();
    line.advance(20s);
    const auto statuses = line.statuses();
    return check_values(statuses, line.words);
}

/// Registers that are too far apart for one request.
struct ModbusPlant {
    explicit ModbusPlant(std::size_t under_way)
    {
        ModbusProtocolOptions options;
        options.client.max_under_way = under_way;
        for (std::size_t i = 0; i < count; ++i) {
            const auto offset = static_cast<std::uint16_t>(10 + i * apart);
            plc.table(ModbusTable::HoldingRegister)[offset] = offset;
            const auto point = parse_modbus_point("holding:" + std::to_string(offset), options);
            REQUIRE(point);
            points.push_back(*point);
            addresses.push_back(point->address);
        }
        line.emplace(DeviceConfig{.name = "press"}, make_modbus_protocol(options, points));
    }
    void connect_again()
    {
        connect(*line, [this]() -> ModbusResponder& {
            responder = ModbusResponder{plc};
            return responder;
        });
    }

    ModbusDevice plc;
    ModbusResponder responder{plc};
    std::vector<DevicePoint> points;
    std::vector<PlanAddress> addresses;
    std::optional<test::Line<ModbusResponder>> line;
};

struct SlmpPlant {
    explicit SlmpPlant(SlmpFrame frame, bool has_lists)
        : plc{{.has_random = has_lists, .has_blocks = has_lists, .max_words = 960}}
    {
        REQUIRE(plc.add_devices("D", 1'000));
        SlmpProtocolOptions options;
        options.client.frame = frame;
        options.finds_frame = false;
        options.client.max_under_way = 2;
        for (std::size_t i = 0; i < count; ++i) {
            const std::string text = "D" + std::to_string(10 + i * apart);
            REQUIRE(plc.set(text, static_cast<std::uint16_t>(10 + i * apart)));
            const auto point = parse_slmp_point(text, options);
            REQUIRE(point);
            points.push_back(*point);
            addresses.push_back(point->address);
        }
        line.emplace(DeviceConfig{.name = "mixer"}, make_slmp_protocol(options, points));
    }
    void connect_again()
    {
        connect(*line, [this]() -> SlmpResponder& {
            plc.reconnect();
            return plc;
        });
    }

    SlmpResponder plc;
    std::vector<DevicePoint> points;
    std::vector<PlanAddress> addresses;
    std::optional<test::Line<SlmpResponder>> line;
};

} // namespace

TEST_CASE("no fault of a Modbus device makes a wrong value, and all is read after it")
{
    using Kind = ModbusFault::Kind;
    const auto kind =
        GENERATE(Kind::Silent, Kind::Exception, Kind::Late, Kind::Overtaken, Kind::Twice,
                 Kind::WrongTransaction, Kind::WrongUnit, Kind::WrongFunction, Kind::Oversize,
                 Kind::Undersize, Kind::OtherProtocol, Kind::Cut, Kind::Short, Kind::Long);
    const std::size_t under_way = GENERATE(1U, 4U);
    const std::size_t after = GENERATE(0U, 1U, 3U);
    INFO(static_cast<int>(kind) << " " << under_way << " " << after);
    ModbusPlant plant{under_way};
    plant.connect_again();
    ModbusFault fault{kind};
    fault.after = after;
    fault.bytes = kind == Kind::Long ? 2 : 1;
    fault.delay = 3s;
    plant.plc.disturb(fault);
    const std::size_t good = read_through(*plant.line, plant.addresses);
    CHECK(plant.plc.pending_faults() == 0);
    const bool is_harmless = kind == Kind::Twice || kind == Kind::Overtaken;
    // Without another answer, nothing overtakes.
    const bool may_fail =
        !is_harmless || (kind == Kind::Overtaken && (under_way == 1 || after == 3));
    CHECK((good == count || may_fail));
    CHECK(good >= (is_harmless ? count - 1 : 0));
    if (plant.line->device.state() != DeviceState::Online) {
        plant.connect_again();
    }
    CHECK(read_through(*plant.line, plant.addresses) == count);
}

TEST_CASE("a Modbus device's answer that is cut at any byte makes no wrong value")
{
    for (std::size_t bytes = 0; bytes <= 11; ++bytes) {
        INFO(bytes);
        ModbusPlant plant{2};
        plant.connect_again();
        ModbusFault fault{ModbusFault::Kind::Cut};
        fault.after = 1;
        fault.bytes = bytes;
        plant.plc.disturb(fault);
        const std::size_t good = read_through(*plant.line, plant.addresses);
        CHECK(good == (bytes < 11 ? 1 : 2));
        CHECK(plant.line->device.state() != DeviceState::Online);
        plant.connect_again();
        CHECK(read_through(*plant.line, plant.addresses) == count);
    }
}

TEST_CASE("no mishap of an SLMP PLC makes a wrong value, and all is read after it")
{
    const auto frame = GENERATE(SlmpFrame::Frame3E, SlmpFrame::Frame4E);
    const bool has_lists = GENERATE(false, true);
    const auto mishap = GENERATE(SlmpMishap::Refused, SlmpMishap::Silent, SlmpMishap::Twice,
                                 SlmpMishap::WrongSerial, SlmpMishap::TooShort, SlmpMishap::CutOff,
                                 SlmpMishap::Closed);
    INFO(static_cast<int>(frame) << " " << static_cast<int>(mishap) << has_lists);
    SlmpPlant plant{frame, has_lists};
    plant.connect_again();
    // What it does not have is known before.
    REQUIRE(read_through(*plant.line, plant.addresses) == count);
    plant.plc.happen(mishap, 1, 0x0055);
    const std::size_t good = read_through(*plant.line, plant.addresses);
    CHECK((good == count) ==
          (mishap == SlmpMishap::Twice && (frame == SlmpFrame::Frame4E || has_lists)));
    if (plant.line->device.state() != DeviceState::Online) {
        plant.connect_again();
    }
    CHECK(read_through(*plant.line, plant.addresses) == count);
}

TEST_CASE("an SLMP answer that is cut at any byte makes no wrong value")
{
    const auto frame = GENERATE(SlmpFrame::Frame3E, SlmpFrame::Frame4E);
    // The answer has a head, an end code and four words.
    const std::size_t whole = (frame == SlmpFrame::Frame4E ? 13U : 9U) + 2 + 2 * count;
    for (std::size_t bytes = 0; bytes <= whole; ++bytes) {
        INFO(bytes);
        SlmpPlant plant{frame, true};
        plant.connect_again();
        REQUIRE(plant.line->device.read(plant.addresses, plant.line->now));
        const auto request = plant.line->device.output();
        plant.plc.feed(request, plant.line->now);
        plant.line->device.consume(request.size());
        const auto answer = plant.plc.output();
        REQUIRE(answer.size() == whole);
        static_cast<void>(plant.line->device.feed(answer.first(bytes), plant.line->now));
        plant.line->cut("the cable is out");
        const auto statuses = plant.line->statuses();
        CHECK(check_values(statuses, plant.line->words) == (bytes == whole ? count : 0));
        plant.connect_again();
        CHECK(read_through(*plant.line, plant.addresses) == count);
    }
}

TEST_CASE("a device that does not tell its identity is read all the same, and is not asked again")
{
    using Kind = ModbusFault::Kind;
    const auto kind = GENERATE(Kind::Silent, Kind::Exception, Kind::Cut, Kind::Short);
    INFO(static_cast<int>(kind));
    ModbusPlant plant{1};
    plant.plc.disturb({.kind = kind});
    plant.connect_again();
    CHECK(plant.line->device.identity_text().empty());
    CHECK(read_through(*plant.line, plant.addresses) == count);
}

} // namespace device_fault_test
