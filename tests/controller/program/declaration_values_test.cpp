#include <cmath>

#include <catch2/catch.hpp>

#include <busbar/controller/declaration_reader.hpp>

namespace declaration_values_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

using Notation = InitialValue::Notation;

Configured<Program> read_value(const std::string& value)
{
    return read_declarations("VAR_GLOBAL x : INT := " + value + "; END_VAR", "a.st");
}

InitialValue initial_of(const std::string& value)
{
    auto program = read_value(value);
    if (!program) {
        FAIL(busbar::text(program.error()));
    }
    return program->variables.at(0).initial;
}

Variant value_of(const std::string& value)
{
    return initial_of(value).value;
}

Variant whole(std::int64_t number)
{
    return Variant{number};
}

std::string text_of(const std::string& value)
{
    const Variant text = value_of(value);
    REQUIRE(text.get_if<String>() != nullptr);
    return text.get_if<String>()->str();
}

double milliseconds_of(const std::string& value)
{
    const InitialValue initial = initial_of(value);
    CHECK(initial.notation == Notation::Duration);
    return initial.value.value_or(-1.0);
}

std::string time_of(const std::string& value, Notation notation)
{
    const InitialValue initial = initial_of(value);
    CHECK(initial.notation == notation);
    return to_string(initial.value.value_or(DateTime{}));
}

} // namespace

TEST_CASE("Numbers are written in several bases, with underscores and types (6-2-2)")
{
    CHECK(value_of("0") == whole(0));
    CHECK(value_of("-1_000") == whole(-1'000));
    CHECK(value_of("+7") == whole(7));
    CHECK(value_of("16#fF_00") == whole(0xFF00));
    CHECK(value_of("2#1010_1010") == whole(0xAA));
    CHECK(value_of("8#777") == whole(0777));
    CHECK(value_of("-9223372036854775808") == whole(INT64_MIN));
    CHECK(value_of("18446744073709551615") == Variant{UINT64_MAX});
    CHECK(value_of("INT#-32768") == whole(-32'768));
    CHECK(value_of("byte#16#FF") == whole(255));
    CHECK(value_of("ULINT#16#FFFF_FFFF_FFFF_FFFF") == Variant{UINT64_MAX});
    CHECK(value_of("BOOL#1") == whole(1));
    CHECK(value_of("TRUE") == Variant{true});
    CHECK(value_of("bool#false") == Variant{false});
    CHECK(value_of("1.5e-3") == Variant{1.5e-3});
    CHECK(value_of("-1_0.25") == Variant{-10.25});
    CHECK(value_of("LREAL#-2.5E+2") == Variant{-250.0});
    CHECK(value_of("REAL#5") == whole(5));
    CHECK(value_of("2e3") == Variant{2000.0});
}

TEST_CASE("Texts have escapes that begin with a dollar sign (6-2-2)")
{
    CHECK(text_of("'plain'") == "plain");
    CHECK(text_of("''").empty());
    CHECK(text_of("'$$ $' $L$N$P$R$T'") == "$ ' \n\n\f\r\t");
    CHECK(text_of("'say \"so\" $C3$A4'") == "say \"so\" \xC3\xA4");
    CHECK(text_of("\"it's $\"so$\" $00e4$20AC$0041\"") == "it's \"so\" \xC3\xA4\xE2\x82\xAC"
                                                          "A");
    CHECK(text_of("STRING#'typed // (* not a comment'") == "typed // (* not a comment");
    CHECK(initial_of("'On'").notation == Notation::Text);
}

TEST_CASE("Times are in milliseconds (6-2-2)")
{
    CHECK(milliseconds_of("T#5s") == 5'000);
    CHECK(milliseconds_of("TIME#1d2h3m4s5ms") == 93'784'005);
    CHECK(milliseconds_of("t#1H_30M") == 5'400'000);
    CHECK(milliseconds_of("T#1h2m3.5s") == 3'723'500);
    CHECK(milliseconds_of("T#-2.5ms") == -2.5);
    CHECK(milliseconds_of("T#90m") == 5'400'000);
    CHECK(milliseconds_of("T#1ms500us") == 1.5);
}

TEST_CASE("Dates and times of day are DateTimes (6-2-2)")
{
    CHECK(time_of("D#2026-11-24", Notation::Date) == "2026-11-24T00:00:00Z");
    CHECK(time_of("DATE#2024-2-29", Notation::Date) == "2024-02-29T00:00:00Z");
    CHECK(time_of("TOD#23:59:59.5", Notation::TimeOfDay) == "1601-01-01T23:59:59.5Z");
    CHECK(time_of("TIME_OF_DAY#1:02", Notation::TimeOfDay) == "1601-01-01T01:02:00Z");
    CHECK(time_of("DT#2026-11-24-14:22:05.1234567", Notation::DateAndTime) ==
          "2026-11-24T14:22:05.1234567Z");
    CHECK(time_of("date_and_time#1601-01-01-00:00:01", Notation::DateAndTime) ==
          "1601-01-01T00:00:01Z");
}

TEST_CASE("Enumerators stand with or without their enumeration (6-2-2)")
{
    for (const char* written : {"Mode#On", "Mode.On", "On"}) {
        const InitialValue initial = initial_of(written);
        CHECK(initial.value == Variant{String{"On"}});
        CHECK(initial.notation == Notation::Enumerator);
        CHECK(initial.enumeration == (std::string{written} == "On" ? "" : "Mode"));
    }
}

TEST_CASE("Structures and arrays have initial values in parts (6-2-2)")
{
    const InitialValue point = initial_of("(X := 1, Inner := (Y := TRUE, Row := [1, 3(0), 2()]))");
    REQUIRE(point.parts.size() == 2);
    CHECK(point.parts[0].member == "X");
    CHECK(point.parts[0].value == whole(1));
    CHECK(point.value.is_null());
    REQUIRE(point.parts[1].parts.size() == 2);
    const InitialValue& row = point.parts[1].parts[1];
    CHECK(row.member == "Row");
    REQUIRE(row.parts.size() == 3);
    CHECK(row.parts[1].repeat == 3);
    CHECK(row.parts[1].value == whole(0));
    CHECK(row.parts[1].place.column == 66);
    CHECK(row.parts[2].repeat == 2);
    CHECK(row.parts[2].empty());
    const InitialValue table = initial_of("[[1, -2], 2([3, 4]), 2((X := 1))]");
    REQUIRE(table.parts.size() == 3);
    CHECK(table.parts[0].parts[1].value == whole(-2));
    CHECK(table.parts[1].repeat == 2);
    CHECK(table.parts[2].parts[0].member == "X");
}

TEST_CASE("Values that are written wrongly are told (6-2-2)")
{
    const auto problem_of = [](const std::string& value) {
        const auto program = read_value(value);
        REQUIRE_FALSE(program);
        CHECK(program.error().where == "a.st:1:23");
        return program.error().text;
    };
    CHECK(problem_of("16#FG") == "found '16#FG', expected a number of base 16");
    CHECK(problem_of("2#12") == "found '2#12', expected a number of base 2");
    CHECK(problem_of("3#12") == "found '3#12', expected 2#, 8# or 16#");
    CHECK(problem_of("1__0") == "found '1__0', expected underscores between two digits only");
    CHECK(problem_of("12ab") == "found '12ab', expected a number of base 10");
    CHECK(problem_of("18446744073709551616") ==
          "found '18446744073709551616', expected a number of at most 64 bits");
    CHECK(problem_of("1e999") == "found '1e999', expected a number that an LREAL can be");
    CHECK(problem_of("INT#32768") ==
          "found 'INT#32768', expected a value of the type before the '#'");
    CHECK(problem_of("USINT#-1") ==
          "found 'USINT#-1', expected a value of the type before the '#'");
    CHECK(problem_of("INT#") == "found 'INT#', expected a number after the '#'");
    CHECK(problem_of("BOOL#2") == "found 'BOOL#2', expected a value of the type before the '#'");
    CHECK(problem_of("STRING#5") == "found 'STRING#5', expected a text in quotes after the '#'");
    CHECK(problem_of("ANY#5") == "found 'ANY#5', expected a value of a type that is known here");
    CHECK(problem_of("LTIME#5") == "found 'LTIME#5', expected a duration as T#1h2m3.5s");
    CHECK(problem_of("WSTRING#5") == "found 'WSTRING#5', expected a text in quotes after the '#'");
    CHECK(problem_of("Mode#1") ==
          "found 'Mode#1', expected the name of a type, '#' and a value of it");
    CHECK(problem_of("'a$x'") == "found ''a$x'', expected $ before $, \", ', L, N, P, R, T or two "
                                 "hexadecimal digits, not 00");
    CHECK(problem_of("'$00'") == "found ''$00'', expected $ before $, \", ', L, N, P, R, T or two "
                                 "hexadecimal digits, not 00");
    CHECK(problem_of("'$C3'") == "found ''$C3'', expected a text of UTF-8");
    CHECK(problem_of("\"$D800\"") == "found '\"$D800\"', expected a text of UTF-8");
    CHECK(problem_of("'open") == "found a text without an end in its line, expected \"'\"");
    CHECK(problem_of("END_VAR") == "found 'END_VAR', expected a value");
    CHECK(problem_of("INT") == "found 'INT', expected a value");
    for (const char* duration :
         {"T#5", "T#", "T#1s2h", "T#1s1s", "T#1.5h2m", "T#1s_", "T#5x", "T#1234567890123456789s"}) {
        CHECK(problem_of(duration) ==
              "found '" + std::string{duration} + "', expected a duration as T#1h2m3.5s");
    }
    for (const char* date : {"D#2026-02-29", "D#1600-12-31", "D#2026-13-01", "D#2026-1", "D#26"}) {
        CHECK(problem_of(date) ==
              "found '" + std::string{date} + "', expected a date from 1601 on as D#2025-12-31");
    }
    for (const char* time : {"TOD#24:00:00", "TOD#1:60", "TOD#1", "TOD#1:02:60"}) {
        CHECK(problem_of(time) ==
              "found '" + std::string{time} + "', expected a time of day as TOD#23:59:59.5");
    }
    CHECK(problem_of("DT#2026-11-24") ==
          "found 'DT#2026-11-24', expected a date from 1601 on and a time as "
          "DT#2025-12-31-23:59:59");
}

} // namespace declaration_values_test
