#include <busbar/backend/device.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/harness/log_book.hpp>
#include <busbar/harness/modbus_responder.hpp>
#include <busbar/harness/slmp_responder.hpp>

#include "device_line.hpp"

namespace device_test {

// A Device before the harness's PLCs, in virtual time and without a network.

using namespace busbar;
using namespace busbar::backend;
using namespace busbar::harness;
using test::Line;
using namespace std::chrono_literals;

namespace {

const StatusCode good{};

DevicePoint modbus_point(std::string_view text)
{
    const auto point = parse_modbus_point(text);
    REQUIRE(point);
    return *point;
}

DevicePoint slmp_point(std::string_view text, const SlmpProtocolOptions& options = {})
{
    const auto point = parse_slmp_point(text, options);
    REQUIRE(point);
    return *point;
}

std::vector<PlanAddress> addresses_of(const std::vector<DevicePoint>& points)
{
    std::vector<PlanAddress> all;
    std::ranges::transform(points, std::back_inserter(all),
                           [](const DevicePoint& point) { return point.address; });
    return all;
}

struct ModbusPlant {
    explicit ModbusPlant(const ModbusProtocolOptions& options = {})
        : points{modbus_point("holding:0"), modbus_point("holding:1:int32"),
                 modbus_point("holding:10"), modbus_point("holding:3"), modbus_point("coil:7")},
          line{{.name = "press"}, make_modbus_protocol(options, points)}
    {
        auto registers = plc.table(ModbusTable::HoldingRegister);
        for (std::size_t i = 0; i < registers.size(); ++i) {
            registers[i] = static_cast<std::uint16_t>(100 + i);
        }
    }

    ModbusDevice plc;
    ModbusResponder responder{plc};
    std::vector<DevicePoint> points;
    Line<ModbusResponder> line;
};

} // namespace

TEST_CASE("a device reads what it can in one request, whatever the order")
{
    ModbusPlant plant;
    CHECK(plant.line.read(addresses_of(plant.points)) ==
          std::vector<StatusCode>{status::Bad_NoCommunication});
    plant.line.connect(plant.responder);
    CHECK(plant.line.device.state() == DeviceState::Online);
    CHECK(plant.line.device.trouble().empty());
    CHECK(plant.line.read(addresses_of(plant.points)) == std::vector<StatusCode>(5, good));
    CHECK(plant.line.words == std::vector<std::uint16_t>{100, 101, 102, 110, 103, 0});
    CHECK(plant.line.device.plan_counters().requests == 2); // registers and coils
    CHECK(plant.line.device.counters().answers == 2);
}

TEST_CASE("an address that a PLC refuses costs the others nothing")
{
    ModbusPlant plant;
    plant.plc.refuse(ModbusTable::HoldingRegister, 3, 1);
    plant.line.connect(plant.responder);
    const auto statuses = plant.line.read(addresses_of(plant.points));
    REQUIRE(statuses.size() == 5);
    CHECK(statuses[3].is_bad());
    CHECK(std::ranges::count(statuses, good) == 4);
    CHECK(plant.line.device.counters().refusals > 0);
    const auto before = plant.line.device.plan_counters().requests;
    CHECK(plant.line.read(addresses_of(plant.points)) == statuses);
    // What was refused is known, and is not asked for again at once.
    CHECK(plant.line.device.plan_counters().requests - before <= 3);
}

TEST_CASE("what waits when a connection is lost has no communication, and it is told once")
{
    ModbusPlant plant;
    plant.line.connect(plant.responder);
    REQUIRE(plant.line.device.read(addresses_of(plant.points), plant.line.now));
    plant.line.cut("the cable is out");
    CHECK(plant.line.statuses() == std::vector<StatusCode>(5, status::Bad_NoCommunication));
    CHECK(plant.line.device.trouble() == "the cable is out");
    CHECK(plant.line.device.output().empty());
    for (int i = 0; i < 3; ++i) {
        plant.line.now = plant.line.device.next_deadline();
        REQUIRE(plant.line.device.wants_connection(plant.line.now));
        plant.line.device.connecting(plant.line.now);
        plant.line.device.lost("the cable is out", plant.line.now);
    }
    const std::string told = plant.line.log.text();
    const auto first = told.find("the cable is out");
    CHECK(first != std::string::npos);
    CHECK(told.find("the cable is out", first + 1) == std::string::npos);
}

TEST_CASE("a device connects again after pauses that grow to a limit")
{
    ModbusPlant plant;
    Duration before{0};
    for (int i = 0; i < 12; ++i) {
        REQUIRE(plant.line.device.wants_connection(plant.line.now));
        plant.line.device.connecting(plant.line.now);
        plant.line.device.lost("refused", plant.line.now);
        CHECK_FALSE(plant.line.device.wants_connection(plant.line.now));
        const Duration pause = plant.line.device.next_deadline() - plant.line.now;
        CHECK(pause >= before * 3 / 4);
        CHECK(pause <= 30s);
        before = pause;
        plant.line.now = plant.line.device.next_deadline();
    }
    CHECK(before > 20s);
    plant.line.connect(plant.responder);
    CHECK(plant.line.read(addresses_of(plant.points)) == std::vector<StatusCode>(5, good));
    plant.line.cut("the PLC restarts");
    CHECK(plant.line.device.next_deadline() - plant.line.now <= 500ms);
}

TEST_CASE("a PLC that takes connections only to close them is asked less and less often")
{
    ModbusPlant plant;
    Duration pause{0};
    for (int i = 0; i < 12; ++i) {
        REQUIRE(plant.line.device.wants_connection(plant.line.now));
        plant.line.device.connecting(plant.line.now);
        plant.line.device.connected(plant.line.now);
        plant.line.cut("it closed the connection");
        pause = plant.line.device.next_deadline() - plant.line.now;
        plant.line.now = plant.line.device.next_deadline();
    }
    CHECK(pause > 20s);
    for (const std::string text : {": connected", "it closed the connection"}) {
        const std::string told = plant.line.log.text();
        const auto first = told.find(text);
        CHECK(first != std::string::npos);
        CHECK(told.find(text, first + 1) == std::string::npos);
    }
}

TEST_CASE("a request without an answer is late by itself, and others go on")
{
    ModbusProtocolOptions options;
    options.client.max_under_way = 2;
    ModbusPlant plant{options};
    plant.line.connect(plant.responder);
    plant.plc.disturb({.kind = ModbusFault::Kind::Silent});
    REQUIRE(plant.line.device.read(addresses_of(plant.points), plant.line.now));
    plant.line.move();
    plant.line.advance(2s);
    const auto statuses = plant.line.statuses();
    CHECK(std::ranges::count(statuses, StatusCode{status::Bad_Timeout}) >= 1);
    CHECK(std::ranges::count(statuses, good) >= 1);
    CHECK(plant.line.device.state() == DeviceState::Online);
    CHECK(plant.line.read(addresses_of(plant.points)) == std::vector<StatusCode>(5, good));
}

TEST_CASE("writes reach the PLC, and a bit of a register leaves the others alone")
{
    ModbusPlant plant;
    plant.line.connect(plant.responder);
    const DevicePoint bit = modbus_point("holding:10.0");
    std::vector<std::uint16_t> word(1);
    const auto mask = write_point(bit, Variant{true}, word);
    REQUIRE(mask);
    const std::vector<std::uint16_t> numbers{1, 2};
    const std::vector<PlanWrite> writes{{plant.points[1].address, numbers},
                                        {bit.address, word, *mask}};
    REQUIRE(plant.line.device.write(writes, plant.line.now));
    plant.line.move();
    CHECK(plant.line.statuses() == std::vector<StatusCode>(2, good));
    const auto registers = plant.plc.table(ModbusTable::HoldingRegister);
    CHECK(registers[1] == 1);
    CHECK(registers[2] == 2);
    CHECK(registers[10] == (110 | 1));
}

TEST_CASE("a PLC that knows no frame 4E is asked in 3E the next time")
{
    SlmpResponder plc{{.takes_4e = false}};
    plc.add_devices("D", 1'000);
    plc.set("D100", 0x1234);
    plc.set("D101", 0x5678);
    const std::vector<DevicePoint> points{slmp_point("D100:int32"), slmp_point("D101")};
    Line<SlmpResponder> line{{.name = "mixer"}, make_slmp_protocol({}, points)};
    line.connect(plc);
    CHECK(line.device.state() == DeviceState::Connecting);
    line.advance(6s);
    CHECK(line.device.state() == DeviceState::Waiting);
    CHECK(line.device.trouble() == "it has no answer to a frame 4E");
    line.now = line.device.next_deadline();
    plc.reconnect();
    line.connect(plc);
    REQUIRE(line.device.state() == DeviceState::Online);
    CHECK(line.device.identity().product == "R08CPU");
    CHECK(line.read(addresses_of(points)) == std::vector<StatusCode>(2, good));
    CHECK(line.device.plan_counters().requests == 1);
    CHECK(line.words == std::vector<std::uint16_t>{0x1234, 0x5678, 0x5678});
    const auto value = read_point(points[0], std::span{line.words}.first(2));
    REQUIRE(value);
    CHECK(*value == Variant{std::int32_t{0x56781234}});
    // It is remembered, until another PLC takes the place.
    line.cut("gone");
    line.now = line.device.next_deadline();
    plc.reconnect();
    line.connect(plc);
    CHECK(line.device.state() == DeviceState::Online);
}

TEST_CASE("a PLC's name is shown without what cannot be shown")
{
    SlmpResponder plc{{.type_name = "R08\x01\xFF\nCPU"}};
    plc.add_devices("D", 10);
    const std::vector<DevicePoint> points{slmp_point("D7")};
    Line<SlmpResponder> line{{.name = "mixer"}, make_slmp_protocol({}, points)};
    line.connect(plc);
    CHECK(line.device.identity().product == "R08CPU");
}

TEST_CASE("a PLC that refuses the long form is asked in the short one")
{
    SlmpResponder plc{{.takes_long_form = false}};
    plc.add_devices("D", 100);
    plc.set("D7", 42);
    const std::vector<DevicePoint> points{slmp_point("D7"), slmp_point("D5000")};
    Line<SlmpResponder> line{{.name = "mixer"}, make_slmp_protocol({}, points)};
    line.connect(plc);
    const auto statuses = line.read(addresses_of(points));
    REQUIRE(statuses.size() == 2);
    CHECK(statuses[0] == good);
    CHECK(statuses[1].is_bad());
    CHECK(line.words.front() == 42);
    const auto served = plc.served();
    CHECK(line.read(addresses_of(points)) == statuses);
    CHECK(plc.served() - served <= 1);
}

TEST_CASE("a PLC in the long form has bits, words and texts")
{
    SlmpResponder plc;
    plc.add_devices("D", 1'000);
    plc.add_devices("X", 0x100);
    plc.set("X1F", 1);
    plc.set("D10", 0x6241); // "Ab"
    plc.set("D20", 8);
    const std::vector<DevicePoint> points{slmp_point("X1F"), slmp_point("D10:text4"),
                                          slmp_point("D20.3"), slmp_point("D9999")};
    Line<SlmpResponder> line{{.name = "mixer"}, make_slmp_protocol({}, points)};
    line.connect(plc);
    const auto statuses = line.read(addresses_of(points));
    REQUIRE(statuses.size() == 4);
    CHECK(std::ranges::count(statuses, good) == 3);
    CHECK(statuses[3].is_bad());
    REQUIRE(line.words.size() == 5);
    CHECK(line.words[0] == 1);
    CHECK(*read_point(points[1], std::span{line.words}.subspan(1, 2)) == Variant{String{"Ab"}});
    CHECK(*read_point(points[2], std::span{line.words}.subspan(3, 1)) == Variant{true});
    CHECK_FALSE(points[2].is_writable);
}

TEST_CASE("addresses of a PLC that have no meaning are refused with their column")
{
    const auto refused = [](std::string_view text) {
        const auto point = parse_slmp_point(text);
        return point ? std::string{"taken"} : point.error().where;
    };
    CHECK(refused("D100:int33") == "column 6");
    CHECK(refused("M5:int16") == "column 3");
    CHECK(refused("LTN0") == "column 1");
    CHECK(refused("LZ0:int16") == "column 4");
    CHECK(refused("LZ0") == "taken");
    CHECK(refused("D1:bool") == "column 3");
    CHECK(refused("D0:float:CDAB") == "taken");
    CHECK(refused("Q1") == "column 1");
}

TEST_CASE("a scale goes through two points, and rounds to what the PLC has")
{
    DevicePoint point = modbus_point("holding:0:int16");
    point.scale = DeviceScale{0, 27'648, 0, 400};
    CHECK(data_type_of(point) == BuiltInType::Double);
    std::vector<std::uint16_t> word{13'824};
    CHECK(*read_point(point, word) == Variant{200.0});
    CHECK(write_point(point, Variant{100.01}, word));
    CHECK(word.front() == 6'913);
    CHECK(write_point(point, Variant{1'000.0}, word).error() == StatusCode{status::Bad_OutOfRange});
    CHECK(write_point(point, Variant{1}, word).error() == StatusCode{status::Bad_TypeMismatch});
    CHECK(write_point(point, Variant{std::numeric_limits<double>::quiet_NaN()}, word).error() ==
          StatusCode{status::Bad_OutOfRange});
    CHECK(word.front() == 6'913);
}

} // namespace device_test
