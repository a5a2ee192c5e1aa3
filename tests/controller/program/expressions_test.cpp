#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/plcopen_xml.hpp>
#include <busbar/controller/program_types.hpp>

#include "controller/program/constant_table.hpp"
#include "controller/program/program_problem.hpp"

namespace expressions_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

struct Outcome {
    InitialValue value{};
    std::string problem{};
};

/// Reads `x : INT := expression` after the declarations.
Outcome value_of(const std::string& expression, const std::string& before = {})
{
    const auto program =
        read_declarations(before + "VAR_GLOBAL x : INT := " + expression + "; END_VAR", "m.st");
    if (!program) {
        return {.value = {}, .problem = text(program.error())};
    }
    return {.value = program->variables.back().initial, .problem = {}};
}

std::string words(const InitialValue& value)
{
    if (const auto* number = value.value.get_if<std::int64_t>()) {
        return std::to_string(*number);
    }
    if (const auto* number = value.value.get_if<std::uint64_t>()) {
        return std::to_string(*number) + "u";
    }
    if (const auto* truth = value.value.get_if<bool>()) {
        return *truth ? "TRUE" : "FALSE";
    }
    if (const auto* real = value.value.get_if<double>()) {
        const auto rounded = static_cast<long long>(std::llround(*real * 1'000));
        return std::to_string(rounded) +
               (value.notation == InitialValue::Notation::Duration ? "us" : "e-3");
    }
    if (const auto* string = value.value.get_if<String>()) {
        return string->str();
    }
    const auto* time = value.value.get_if<DateTime>();
    return time != nullptr ? to_string(*time) : "nothing";
}

struct Row {
    const char* expression;
    const char* value;
};

Configured<Program> read(std::string_view text, Unserved unserved = Unserved::Refuse)
{
    return read_declarations(text, "m.st", {}, unserved);
}

} // namespace

TEST_CASE("Operators of whole numbers are exact, with the precedence of IEC 61131-3")
{
    const Row row = GENERATE(values<Row>({
        {"1 + 2 * 3", "7"},
        {"(1 + 2) * 3", "9"},
        {"10 - 4 - 3", "3"},
        {"-2 ** 2", "4"},
        {"2 ** 3 ** 2", "64"},
        {"2 ** 10", "1024"},
        {"-7 / 2", "-3"},
        {"-7 MOD 2", "-1"},
        {"7 MOD -2", "1"},
        {"- (3 - 5)", "2"},
        {"+ (3)", "3"},
        {"16#10+2#11-8#7", "12"},
        {"INT#5-1", "4"},
        {"INT#-5+1", "-4"},
        {"9223372036854775807 + 1", "9223372036854775808u"},
        {"-9223372036854775808", "-9223372036854775808"},
        {"-9223372036854775807 - 1", "-9223372036854775808"},
        {"18446744073709551615 / 5", "3689348814741910323"},
        {"18446744073709551615 - 18446744073709551615", "0"},
        {"4294967296 * 4294967295", "18446744069414584320u"},
        {"16#F0 AND 16#3C", "48"},
        {"16#F0 & 16#3C OR 1", "49"},
        {"6 XOR 3", "5"},
        {"NOT WORD#16#00FF", "65280"},
        {"NOT INT#5", "-6"},
        {"NOT TRUE OR TRUE", "TRUE"},
        {"TRUE XOR TRUE", "FALSE"},
        {"1 < 2", "TRUE"},
        {"1<=1", "TRUE"},
        {"2>=3", "FALSE"},
        {"2<>3", "TRUE"},
        {"1 + 1 = 2 AND 3 > 2", "TRUE"},
        {"'a' < 'b'", "TRUE"},
        {"T#1s = T#1000ms", "TRUE"},
    }));
    CAPTURE(row.expression);
    const Outcome outcome = value_of(row.expression);
    CHECK(outcome.problem.empty());
    CHECK(words(outcome.value) == row.value);
}

TEST_CASE("Reals, durations, dates, functions and conversions are computed")
{
    const Row row = GENERATE(values<Row>({
        {"1.0 / 4.0", "250e-3"},
        {"1 / 4.0", "250e-3"},
        {"2 ** -1", "500e-3"},
        {"2.0 ** 0.5 * 2.0 ** 0.5", "2000e-3"},
        {"T#1S + T#2S", "3000000us"},
        {"2 * T#1s - T#500ms", "1500000us"},
        {"T#1s / 4", "250000us"},
        {"DT#2026-01-01-00:00:00 + T#1h", "2026-01-01T01:00:00Z"},
        {"SHL(1, 4)", "16"},
        {"SHL(WORD#16#8001, 1)", "2"},
        {"SHL(BYTE#1, 8)", "0"},
        {"SHR(16#80, 3)", "16"},
        {"SHR(1, 64)", "0"},
        {"ROL(BYTE#16#81, 1)", "3"},
        {"ROR(WORD#1, 1)", "32768"},
        {"ABS(-5)", "5"},
        {"MAX(1, 5, 3)", "5"},
        {"MIN(4, 2.5)", "2500e-3"},
        {"LIMIT(0, 12, 10)", "10"},
        {"SEL(TRUE, 1, 2)", "2"},
        {"EXPT(2, 3)", "8"},
        {"SQRT(9)", "3000e-3"},
        {"TRUNC(-1.9)", "-1"},
        {"LEN('abc')", "3"},
        {"CONCAT('a', 'bc')", "abc"},
        {"INT_TO_REAL(3) / 2", "1500e-3"},
        {"TO_REAL(3)", "3000e-3"},
        {"REAL_TO_INT(2.5)", "2"},
        {"REAL_TO_INT(-3.5)", "-4"},
        {"LREAL_TO_ULINT(1.0E19)", "10000000000000000000u"},
        {"INT_TO_WORD(-1)", "65535"},
        {"BOOL_TO_INT(TRUE)", "1"},
        {"INT_TO_BOOL(4)", "TRUE"},
        {"TIME_TO_DINT(T#1s)", "1000"},
        {"DINT_TO_TIME(1500)", "1500000us"},
        {"SIZEOF(LREAL) * 8", "64"},
    }));
    CAPTURE(row.expression);
    const Outcome outcome = value_of(row.expression);
    CHECK(outcome.problem.empty());
    CHECK(words(outcome.value) == row.value);
}

TEST_CASE("An expression without a result is told with its place")
{
    const Row row = GENERATE(values<Row>({
        {"18446744073709551615 + 1", "m.st:1:44: the operation '+' overflows 64 bits"},
        {"-9223372036854775808 - 1", "m.st:1:44: the operation '-' overflows 64 bits"},
        {"4294967296 * 4294967296", "m.st:1:34: the operation '*' overflows 64 bits"},
        {"10 ** 20", "m.st:1:26: the operation '**' overflows 64 bits"},
        {"1 / 0", "m.st:1:25: the operation '/' divides by zero"},
        {"1 MOD (2 - 2)", "m.st:1:25: the operation 'MOD' divides by zero"},
        {"1.0 / 0.0", "m.st:1:27: the operation '/' divides by zero"},
        {"0 ** -1", "m.st:1:25: the operation '**' divides by zero"},
        {"1.0E308 * 10.0", "m.st:1:31: the operation '*' has a result that an LREAL cannot be"},
        {"1.5 MOD 1.0", "m.st:1:27: the operation 'MOD' needs whole numbers"},
        {"SHL(1, 64)", "m.st:1:23: the operation 'SHL' overflows 64 bits"},
        {"REAL_TO_INT(70000.0)",
         "m.st:1:23: the operation 'REAL_TO_INT' has a value that INT cannot be"},
        {"TO_INT('5')", "m.st:1:23: the operation 'TO_INT' cannot become INT"},
        {"SQRT(-1)", "m.st:1:23: the operation 'SQRT' needs a number from 0 on"},
        {"NOT 5", "m.st:1:23: the operation 'NOT' needs a value of BOOL or of a type, as "
                  "WORD#16#FF"},
        {"1 AND TRUE",
         "m.st:1:25: the operation 'AND' needs two values of BOOL or two whole numbers"},
        {"1 = 'a'", "m.st:1:25: the operation '=' compares values of different kinds"},
        {"'a' + 'b'", "m.st:1:27: the operation '+' needs two numbers, or a duration and a number"},
        {"MAX(1)", "m.st:1:23: the operation 'MAX' has 1 arguments, expected 2 or more"},
        {"ADR(y)", "m.st:1:23: found 'ADR', expected a value, or a function that is computed here"},
        {"SIZEOF(Nothing)",
         "m.st:1:30: found 'Nothing', expected the name of a type whose size is known"},
        {"N + 1", "m.st:1:23: found 'N', which is neither a constant nor a value of an enumeration "
                  "that is declared here"},
        {"(1 + 2", "m.st:1:29: found ';', expected ')'"},
        {"1 +", "m.st:1:26: found ';', expected a value"},
    }));
    CAPTURE(row.expression);
    CHECK(value_of(row.expression).problem == row.value);
}

TEST_CASE("Constants and values of enumerations are known before and after their declaration")
{
    const std::string declarations =
        "VAR_GLOBAL CONSTANT N : INT := 4; R : REAL := 4; S : STRING := 'ab'; W : WORD := 16#FF; "
        "M : INT := N * 2 + Late; c : Color := Green; END_VAR\n"
        "TYPE Color : (Red := N, Green, Blue := Red + 10) INT; Other : (Red, Last); END_TYPE\n";
    const std::string after = "VAR_GLOBAL CONSTANT Late : DINT := Color.Blue; END_VAR ";
    const Row row = GENERATE(values<Row>({
        {"N", "4"},
        {"n", "4"},
        {"GVL.N", "4"},
        {"Lib.GVL.N * 2", "8"},
        {"R / 8", "500e-3"},
        {"N / 8", "0"},
        {"CONCAT(S, S)", "abab"},
        {"NOT W", "65280"},
        {"M", "22"},
        {"Late + 0", "14"},
        {"Color.Red + 0", "4"},
        {"Color#Green-1", "4"},
        {"Color.Green", "5"},
        {"Green", "5"},
        {"Lib.Color.Blue", "14"},
        {"Last", "1"},
        {"Other#Red", "0"},
        {"c", "5"},
        {"N-1", "3"},
    }));
    CAPTURE(row.expression);
    const Outcome before = value_of(row.expression, declarations + after);
    CHECK(before.problem.empty());
    CHECK(words(before.value) == row.value);
    const auto program = read("VAR_GLOBAL x : INT := " + std::string{row.expression} +
                              "; END_VAR " + declarations + after);
    REQUIRE(program);
    CHECK(words(program->variables.front().initial) == row.value);
}

TEST_CASE("Bounds, lengths, subranges, enumerations, repetitions and SIZEOF take expressions")
{
    const auto program = read(
        "VAR_GLOBAL a : ARRAY [-N..2*N-1, 0..SIZEOF(Point)-1] OF STRING[N*2];\n"
        "  b : INT (0..GVL.N) := N - 1; l : ARRAY [1..N] OF INT := [N-2(7), N, (N + 1) * 2];\n"
        "  c : Color := 5; d : ARRAY [0..1] OF Color := [Color#Red, 5]; p : Pair := (n := Red); "
        "END_VAR\n"
        "TYPE Color : (Red := N, Green); Pair : STRUCT n : INT; END_STRUCT\n"
        "Point : STRUCT a : BOOL; b : ARRAY [0..N] OF DINT; c : INT; END_STRUCT END_TYPE\n"
        "VAR_GLOBAL CONSTANT N : INT := 4; END_VAR\n");
    if (!program) {
        FAIL(text(program.error()));
    }
    const auto& variables = program->variables;
    CHECK(variables.at(0).type.dimensions.at(0) == Bounds{-4, 7});
    CHECK(variables.at(0).type.dimensions.at(1) == Bounds{0, 27});
    CHECK(variables.at(0).type.string_length == 8);
    CHECK(variables.at(1).type.subrange == Bounds{0, 4});
    CHECK(words(variables.at(1).initial) == "3");
    REQUIRE(variables.at(2).initial.parts.size() == 3);
    CHECK(variables.at(2).initial.parts.at(0).repeat == 2);
    CHECK(words(variables.at(2).initial.parts.at(0)) == "7");
    CHECK(words(variables.at(2).initial.parts.at(2)) == "10");
    CHECK(words(variables.at(3).initial) == "Green");
    CHECK(words(variables.at(4).initial.parts.at(0)) == "Red");
    CHECK(words(variables.at(4).initial.parts.at(1)) == "Green");
    CHECK(words(variables.at(5).initial.parts.at(0)) == "4");
}

TEST_CASE("What depends on something wrong is left out with the reason, and nothing else")
{
    const Row row = GENERATE(values<Row>({
        {"A : INT := B + 1; B : INT := C; C : INT := A;",
         "2:23: variable x: found A, which has no value: m.st:1:39: depends on itself: B -> C -> A "
         "-> B"},
        {"A : INT := A;",
         "2:23: variable x: found A, which has no value: m.st:1:21: depends on itself: A -> A"},
        {"A : INT := B; B : INT := 1 / 0;",
         "2:23: variable x: found A, which has no value: m.st:1:35: the operation '/' divides by "
         "zero"},
        {"A : SINT := 200;",
         "2:23: variable x: found A, which has no value: m.st:1:21: has a value that SINT cannot "
         "be"},
        {"A : INT := 1.5;", "2:23: variable x: found A, which has no value: m.st:1:21: has a value "
                            "with digits after the point"},
        {"A : INT := Nothing;",
         "2:23: variable x: found A, which has no value: m.st:1:21: found 'Nothing', which is "
         "neither a constant nor a value of an enumeration that is declared here"},
        {"A : INT := Red; END_VAR TYPE E : (Red); F : (Red); END_TYPE VAR_GLOBAL CONSTANT Z : INT "
         ":= 0;",
         "2:23: variable x: found A, which has no value: m.st:1:21: found 'Red', which several "
         "enumerations have, expected the name of one and a point before it"},
    }));
    CAPTURE(row.expression);
    const auto program = read("VAR_GLOBAL CONSTANT " + std::string{row.expression} +
                                  " END_VAR\nVAR_GLOBAL x : INT := A + 0; y : INT := 1; END_VAR",
                              Unserved::LeaveOut);
    REQUIRE(program);
    CHECK(program->variables.back().name == "y");
    std::string reason;
    for (const LeftOut& each : program->left_out) {
        reason = each.declared.name == "x" ? text(each.problem) : reason;
    }
    CHECK(reason == row.value);
}

TEST_CASE("Expressions of hostile files meet a budget")
{
    const auto reason = [](const std::string& expression,
                           const controller::detail::ExpressionLimits& most) {
        controller::detail::ConstantTable constants{most};
        const DeclarationLimits limits;
        controller::detail::MemoryBudget memory{limits.max_memory};
        const controller::detail::TextPlaces places{expression};
        controller::detail::DeclarationCursor cursor{expression, "m.st", &places,
                                                     limits,     memory, constants};
        controller::detail::ExpressionValue value;
        return controller::detail::read_expression(cursor, value) ? "" : text(cursor.problem());
    };
    const auto repeated = [](std::string_view what, int times) {
        std::string all;
        for (int i = 0; i < times; ++i) {
            all += what;
        }
        return all;
    };
    CHECK(reason("1 + 2 + 3", {.max_steps = 5}).empty());
    CHECK(reason("1 + 2 + 3", {.max_steps = 4}) ==
          "m.st:1:1: takes, with the expressions before it, more than 4 steps");
    for (const char* const deep : {"(", "-(", "NOT ", "1 + (", "ABS(", "2 ** ("}) {
        CAPTURE(deep);
        CHECK(reason(repeated(deep, 100'000), {}).find("has more than 100 expressions within") !=
              std::string::npos);
    }
    CHECK(reason("CONCAT('aaa', 'bbb')", {.max_text = 5}) ==
          "m.st:1:1: the operation 'CONCAT' has a text of more than 5 bytes");

    // Each doubles the one before it.
    std::string doubling = "VAR_GLOBAL CONSTANT c0 : STRING[99999] := 'aaaaaaaa';\n";
    std::string chain = "VAR_GLOBAL CONSTANT\n";
    for (int i = 1; i < 1'000; ++i) {
        const std::string before = "c" + std::to_string(i - 1);
        doubling += "c" + std::to_string(i) + " : STRING[99999] := CONCAT(" + before + ", " +
                    before + ");\n";
        chain += before + " : INT := c" + std::to_string(i) + ";\n";
    }
    const auto texts = read(doubling + "END_VAR", Unserved::LeaveOut);
    REQUIRE(texts);
    CHECK(texts->variables.size() == 14);
    const auto deep = read(chain + "c999 : INT := 5; END_VAR", Unserved::LeaveOut);
    REQUIRE(deep);
    // Of each 101 the last one depends on 100, and is wrong for those before it.
    CHECK(deep->variables.size() == 91);
    CHECK(text(deep->left_out.front().problem).find("depends on more than 100 others") !=
          std::string::npos);
}

} // namespace expressions_test
