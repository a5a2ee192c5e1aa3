#include <cmath>

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
    return read->variables[0].signal;
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

TEST_CASE("a number is of a type only if that has it")
{
    const Variant byte{std::uint8_t{0}};
    CHECK(number_like(byte, 254.5) == Variant{std::uint8_t{255}});
    CHECK(number_like(byte, 255.5).is_null());
    CHECK(number_like(byte, -1).is_null());
    CHECK(number_like(byte, std::nan("")).is_null());
    CHECK(number_like(Variant{std::uint64_t{0}}, 1.5e19) ==
          Variant{std::uint64_t{15'000'000'000'000'000'000U}});
    CHECK(number_like(Variant{std::int64_t{0}}, 9.3e18).is_null());
    CHECK(number_like(Variant{0.0F}, 1e300).is_null());
    CHECK(number_like(Variant{false}, std::nan("")).is_null());
}

TEST_CASE("a simulation has variables, some for writing")
{
    const auto read =
        read_simulation("# a tank\n\nLevel Double 1.5\r\n\tCount UInt32 7 write", "a");
    REQUIRE(read);
    REQUIRE(read->variables.size() == 2);
    CHECK(read->variables[0].name == "Level");
    CHECK_FALSE(read->variables[0].is_writable);
    CHECK(read->variables[1].name == "Count");
    CHECK(read->variables[1].is_writable);
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
         {"A Double 1\nA Double 2", "a.sim:2: A is there twice"},
         {"A Double 1\nmethod A", "a.sim:2: A is there twice"},
         {"method", "found the end; expected the name of a Method"},
         {"method M with x", "found \"with\"; expected in, out or sets"},
         {"method M in", "found nothing after \"in\""},
         {"method M in a Real", "found the type \"Real\""},
         {"method M out s String", "found the end; expected an input, a value or an expression"},
         {"method M out s Double \"a +\"", "found the end; expected a number, a name or ("},
         {"method M out s Double \"a + 1\"", "found \"a\" in an expression"},
         {"method M sets A 7", "found \"A\" in an expression"},
         {"A Byte 0\nevent full 0 every 1s", "found the severity \"0\"; expected 1 to 1000"},
         {"A Byte 0\nevent full 7 at 1s", "found \"at\"; expected when or every"},
         {"A Byte 0\nevent full 7 every 1h", "found the period \"1h\""},
         {"A Byte 0\nevent full 7 when A<", "found the end; expected a number, a name or ("}}));
    const auto read = read_simulation(text, "a.sim");
    REQUIRE_FALSE(read);
    CHECK_THAT(busbar::text(read.error()), Catch::Contains(what));
}

TEST_CASE("expressions of a simulation are arithmetic")
{
    const auto value = [](const std::string& text) -> std::optional<double> {
        const auto read = Expression::parse(text);
        INFO(text << ": " << (read ? std::string{} : read.error()));
        REQUIRE(read);
        return read->value([](const std::string& name) {
            return name == "a" ? std::optional{7.0} : std::nullopt;
        });
    };
    CHECK(value("1 + 2 * 3 - 4 / 2") == 5.0);
    CHECK(value("-(a - 10) * --2") == 6.0);
    CHECK(value("1.5e1") == 15.0);
    CHECK(value("a >= 7") == 1.0);
    CHECK(value("a + 1 < a") == 0.0);
    CHECK(value("a != 7") == 0.0);
    CHECK(value("b + 1") == std::nullopt);
    CHECK_FALSE(Expression::parse(""));
    CHECK_FALSE(Expression::parse("1 2"));
    CHECK_FALSE(Expression::parse("(1"));
    CHECK_FALSE(Expression::parse("1 < 2 < 3"));
    CHECK(Expression::parse(std::string(50, '(') + "1" + std::string(50, ')')));
    CHECK_FALSE(Expression::parse(std::string(51, '(') + "1" + std::string(51, ')')));
    CHECK_FALSE(Expression::parse(std::string(1'001, '1')));
}

TEST_CASE("a simulation has methods and events")
{
    const auto read = read_simulation("Level Double 1.5\n"
                                      "method Add in a Double b Double out sum Double \"a + b\" "
                                      "out state Int32 7 text String \"at work\" sets Level a\n"
                                      "method Echo in text String out text String text\n"
                                      "event \"too full\" 700 when \"Level > 90\"\n"
                                      "event heartbeat 100 every 10s",
                                      "a");
    INFO((read ? std::string{} : busbar::text(read.error())));
    REQUIRE(read);
    REQUIRE(read->methods.size() == 2);
    const SimulatedMethod& add = read->methods[0];
    REQUIRE(add.inputs.size() == 2);
    REQUIRE(add.outputs.size() == 3);
    CHECK(add.outputs[0].expression.has_value());
    CHECK(add.outputs[1].value == Variant{std::int32_t{7}});
    CHECK(add.outputs[2].value == Variant{String{"at work"}});
    REQUIRE(add.settings.size() == 1);
    CHECK(read->methods[1].outputs[0].input == 0U);
    REQUIRE(read->events.size() == 2);
    CHECK(read->events[0].severity == 700);
    CHECK(read->events[0].condition.has_value());
    CHECK(read->events[1].period == 10s);
}

} // namespace simulation_test
