#include <catch2/catch.hpp>

#include "tool/recordings/simulation.hpp"

namespace simulation_test {

using namespace busbar;
using namespace busbar::tool;
using namespace std::chrono_literals;

namespace {

/// The signal of a line.
SimulatedSignal signal(const std::string& text)
{
    const auto read = read_simulation("X " + text, "a.sim");
    INFO((read ? std::string{} : busbar::text(read.error())));
    REQUIRE(read);
    return (*read)[0].signal;
}

} // namespace

TEST_CASE("simulated values pass with time")
{
    const SimulatedSignal ramp = signal("Double ramp 0 100 60s");
    CHECK(ramp.at(0s) == Variant{0.0});
    CHECK(ramp.at(15s) == Variant{25.0});
    CHECK(ramp.at(75s) == Variant{25.0});
    CHECK(signal("Int16 ramp 10 0 10s").at(3s) == Variant{std::int16_t{7}});
    CHECK(signal("Byte sine 250 20 4s").at(1s) == Variant{std::uint8_t{255}}); // the most it has
    CHECK(signal("Float sine 20 5 4s").at(3s) == Variant{15.0F});
    const SimulatedSignal steps = signal("Boolean steps false true 5s");
    CHECK(steps.at(4s) == Variant{false});
    CHECK(steps.at(5s) == Variant{true});
    CHECK(steps.at(10s) == Variant{false});
    CHECK(signal("String \"at work\"").at(1h) == Variant{String{"at work"}});
    CHECK(signal("UInt32 steps 7 500ms").at(3s) == Variant{std::uint32_t{7}});
}

TEST_CASE("a simulation has variables, some for writing")
{
    const auto read =
        read_simulation("# a tank\n\nLevel Double 1.5\r\n\tCount UInt32 7 write", "a");
    REQUIRE(read);
    REQUIRE(read->size() == 2);
    CHECK((*read)[0].name == "Level");
    CHECK_FALSE((*read)[0].is_writable);
    CHECK((*read)[1].name == "Count");
    CHECK((*read)[1].is_writable);
}

TEST_CASE("what is no simulation is told with its line")
{
    const auto [text, what] = GENERATE(table<const char*, const char*>(
        {{"", "a.sim: found no variable"},
         {"# only\nLevel Double", "a.sim:2: found 2 words; expected NAME TYPE"},
         {"Level Real 7", "found the type \"Real\"; expected a built-in type"},
         {"Level Byte 300", "expected a Byte, 0 to 255, found \"300\""},
         {"Level Byte 3 4", "found 2 words after the type"},
         {"Level Double ramp 0 100", "expected ramp, two numbers and a period"},
         {"Level Double ramp 0 100 60", "found the period \"60\""},
         {"Level Double ramp 0 100 1ms", "found the period \"1ms\""},
         {"Level String sine a b 5s", "sine is for numbers, and not for String"},
         {"Level Double steps 5s", "expected steps, 1 to 1000 values"},
         {"A Double 1\nA Double 2", "a.sim:2: A is there twice"}}));
    const auto read = read_simulation(text, "a.sim");
    REQUIRE_FALSE(read);
    CHECK_THAT(busbar::text(read.error()), Catch::Contains(what));
}

} // namespace simulation_test
