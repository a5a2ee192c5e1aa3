#include <catch2/catch.hpp>

#include <busbar/controller/declaration_reader.hpp>

namespace declaration_errors_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

struct Mistake {
    const char* text;
    const char* problem;
};

std::string problem_of(std::string_view text, const DeclarationLimits& limits = {})
{
    const auto program = read_declarations(text, "m.st", limits);
    return program ? "" : busbar::text(program.error());
}

std::string repeated(std::string_view what, std::size_t times)
{
    std::string text;
    for (std::size_t i = 0; i < times; ++i) {
        text += what;
    }
    return text;
}

/// Has a bit of everything.
constexpr std::string_view sample =
    "\xEF\xBB\xBF{attribute 'publish' := 'input'} (* a (* b *) *)\n"
    "TYPE\n"
    "  Mode : (Off, On := 5) INT := Mode#On; // modes\n"
    "  Level : INT (-5..16#10) := +3;\n"
    "  Row : ARRAY[-1..1, 0..2] OF REAL := [[1.5e3, 2(0.0)], 2([3(-1)])];\n"
    "  Point : STRUCT X, Y : LREAL := 1; S : STRING[8] := 'a$N\xC3\xA4'; END_STRUCT\n"
    "  Either : UNION A : WORD; B : Point; END_UNION;\n"
    "END_TYPE\n"
    "{publish := output} VAR_GLOBAL RETAIN /* c */\n"
    "  a AT %IX0.1 : BOOL := TRUE; (* kept *)\n"
    "  b, c : Point := (X := 2#101, S := \"$00e4\") {publish := 'none'};\n"
    "  t : TIME := T#1h2m3.5s; d : DT := DT#2026-11-24-14:22:05.5;\n"
    "END_VAR\n"
    "CONFIGURATION C RESOURCE R ON Cpu\n"
    "  TASK T1(INTERVAL := T#1ms, PRIORITY := 4); PROGRAM P WITH T1 : Main (x := a);\n"
    "END_RESOURCE END_CONFIGURATION\n";

} // namespace

TEST_CASE("Mistakes in types are told with place, found and expected (3-3-2)")
{
    constexpr Mistake mistakes[]{
        {"TYPE A : END_TYPE", "m.st:1:10: found 'END_TYPE', expected a type that is known here"},
        {"TYPE A : ; END_TYPE", "m.st:1:10: found ';', expected a type"},
        {"TYPE\n\tA INT;", "m.st:2:4: found 'INT', expected ':'"},
        {"TYPE A : INT", "m.st:1:13: found the end of the text, expected ';'"},
        {"TYPE INT : BOOL; END_TYPE",
         "m.st:1:6: found 'INT', expected the name of a type or 'END_TYPE'"},
        {"TYPE A : ANY; END_TYPE", "m.st:1:10: found 'ANY', expected a type that is known here"},
        {"TYPE A : INT (5..1); END_TYPE",
         "m.st:1:15: found the bounds 5..1, expected the lower one first"},
        {"TYPE A : INT (0..x); END_TYPE",
         "m.st:1:18: found 'x', which is neither a constant nor a value of an enumeration that is "
         "declared here"},
        {"TYPE A : INT (0..'x'); END_TYPE", "m.st:1:18: found ''x'', expected a whole number"},
        {"TYPE A : INT (0.5..1); END_TYPE", "m.st:1:15: found '0.5', expected a whole number"},
        {"TYPE A : REAL (0..1); END_TYPE", "m.st:1:15: found '(', expected ';'"},
        {"TYPE A : ARRAY 0..1 OF INT; END_TYPE", "m.st:1:16: found '0', expected '['"},
        {"TYPE A : ARRAY[0..1 OF INT; END_TYPE", "m.st:1:21: found 'OF', expected ',' or ']'"},
        {"TYPE A : ARRAY[0..1] INT; END_TYPE", "m.st:1:22: found 'INT', expected 'OF'"},
        {"TYPE A : ARRAY[MAX] OF INT; END_TYPE",
         "m.st:1:16: found 'MAX', which is neither a constant nor a value of an enumeration that "
         "is declared here"},
        {"TYPE A : STRING[0]; END_TYPE", "m.st:1:17: found '0', expected a length from 1 on"},
        {"TYPE A : STRING[8); END_TYPE", "m.st:1:18: found ')', expected ']'"},
        {"TYPE A : STRUCT B : INT END_STRUCT; END_TYPE",
         "m.st:1:25: found 'END_STRUCT', expected ';'"},
        {"TYPE A : STRUCT B : INT; END_TYPE",
         "m.st:1:26: found 'END_TYPE', expected the name of a member or 'END_STRUCT'"},
        {"TYPE A : UNION B, : INT; END_UNION; END_TYPE",
         "m.st:1:19: found ':', expected the name of a member or 'END_UNION'"},
        {"TYPE A : STRUCT B : INT (C, D); END_STRUCT; END_TYPE",
         "m.st:1:26: found 'C', which is neither a constant nor a value of an enumeration that is "
         "declared here"},
        {"TYPE A : (B, ); END_TYPE", "m.st:1:14: found ')', expected the name of a value"},
        {"TYPE A : (B C); END_TYPE", "m.st:1:13: found 'C', expected ',', ':=' or ')'"},
        {"TYPE A : (B := C); END_TYPE",
         "m.st:1:16: found 'C', which is neither a constant nor a value of an enumeration that is "
         "declared here"},
        {"TYPE A : (B := 2147483648); END_TYPE",
         "m.st:1:16: found the value 2147483648, expected one that is both of the type DINT and of "
         "32 bits with a sign"},
        {"TYPE A : USINT (B := 255, C); END_TYPE",
         "m.st:1:27: found the value 256, expected one that is both of the type before it and of "
         "32 bits with a sign"},
        {"TYPE A : (B := 300) USINT; END_TYPE",
         "m.st:1:21: found 'USINT', expected a type in which the value 300 is"},
        {"TYPE A : (B) REAL; END_TYPE",
         "m.st:1:14: found 'REAL', expected ';', ':=' or a type of whole numbers"},
    };
    for (const Mistake& mistake : mistakes) {
        CAPTURE(mistake.text);
        CHECK(problem_of(mistake.text) == mistake.problem);
    }
}

TEST_CASE("Mistakes in variables are told with place, found and expected (3-3-2)")
{
    constexpr Mistake mistakes[]{
        {"VAR x : INT; END_VAR",
         "m.st:1:1: found 'VAR', expected TYPE, VAR_GLOBAL, CONFIGURATION or RESOURCE"},
        {"VAR_GLOBAL x : INT;",
         "m.st:1:20: found the end of the text, expected the name of a variable or 'END_VAR'"},
        {"VAR_GLOBAL RETAIN NON_RETAIN x : INT; END_VAR",
         "m.st:1:19: found 'NON_RETAIN', expected the name of a variable or 'END_VAR'"},
        {"VAR_GLOBAL x AT 5 : INT; END_VAR", "m.st:1:17: found '5', expected an address as %IX0.0"},
        {"VAR_GLOBAL x AT %QQ5 : INT; END_VAR",
         "m.st:1:17: found '%QQ5', expected an address as %IX0.0"},
        {"VAR_GLOBAL x AT %IX0..1 : INT; END_VAR",
         "m.st:1:17: found '%IX0..1', expected an address as %IX0.0"},
        {"VAR_GLOBAL x, y AT %IX0 : INT; END_VAR",
         "m.st:1:17: found 'AT', expected ':', because an address is for one name"},
        {"VAR_GLOBAL x : INT = 5; END_VAR", "m.st:1:20: found '=', expected ';'"},
        {"VAR_GLOBAL x : INT := - y; END_VAR",
         "m.st:1:25: found 'y', which is neither a constant nor a value of an enumeration that is "
         "declared here"},
        {"VAR_GLOBAL x : A := (1, 2); END_VAR", "m.st:1:23: found ',', expected ')'"},
        {"VAR_GLOBAL x : A := (b := 1; END_VAR", "m.st:1:28: found ';', expected ',' or ')'"},
        {"VAR_GLOBAL x : A := [1; END_VAR", "m.st:1:23: found ';', expected ',' or ']'"},
        {"VAR_GLOBAL x : A := []; END_VAR", "m.st:1:22: found ']', expected a value"},
        {"VAR_GLOBAL x : A := [0(1)]; END_VAR",
         "m.st:1:22: found '0', expected a number of elements from 1 on"},
        {"VAR_GLOBAL x : A := [2(1, 2)]; END_VAR", "m.st:1:25: found ',', expected ')'"},
        {"VAR_GLOBAL x : A := B.5; END_VAR", "m.st:1:23: found '5', expected the name of a value"},
        {"{publish := 'all'} VAR_GLOBAL END_VAR",
         "m.st:1:1: found a publish attribute that is not known, expected 'none', 'publish only', "
         "'input' or 'output'"},
        {"VAR_GLOBAL {publish := 1} x : INT; END_VAR",
         "m.st:1:12: found a publish attribute that is not known, expected 'none', 'publish only', "
         "'input' or 'output'"},
        {"VAR_GLOBAL x {a} : INT; END_VAR", "m.st:1:14: found a pragma, expected ':'"},
        {"VAR_GLOBAL {a", "m.st:1:12: found a pragma without an end, expected '}'"},
        {"VAR_GLOBAL (* (* *)", "m.st:1:12: found a comment without an end, expected '*)'"},
        {"VAR_GLOBAL\n /* (* */ x /* y",
         "m.st:2:13: found a comment without an end, expected '*/'"},
        {"VAR_GLOBAL \xC3\xA4\xC3\xB6 INT; END_VAR", "m.st:1:15: found 'INT', expected ':'"},
        {"VAR_GLOBAL\r\n\r\nx INT; END_VAR", "m.st:3:3: found 'INT', expected ':'"},
        {"VAR_GLOBAL \xC3\xA4\xC3\xB6\xC3( : INT; END_VAR",
         "m.st:1:14: found a byte that is not UTF-8; expected a text that is, or the name of its "
         "encoding"},
        {"VAR_GLOBAL x\x01 : INT; END_VAR", "m.st:1:13: found '\\x01', expected ':'"},
    };
    for (const Mistake& mistake : mistakes) {
        CAPTURE(mistake.text);
        CHECK(problem_of(mistake.text) == mistake.problem);
    }
}

TEST_CASE("Mistakes in configurations are told with place, found and expected (3-3-2)")
{
    constexpr Mistake mistakes[]{
        {"CONFIGURATION C x", "m.st:1:17: found 'x', expected RESOURCE, VAR_GLOBAL, TASK, PROGRAM "
                              "or END_CONFIGURATION"},
        {"RESOURCE R Cpu", "m.st:1:12: found 'Cpu', expected 'ON'"},
        {"RESOURCE R ON Cpu TYPE", "m.st:1:19: found 'TYPE', expected VAR_GLOBAL, TASK, PROGRAM or "
                                   "END_RESOURCE"},
        {"RESOURCE R ON Cpu TASK T (INTERVAL := 5)",
         "m.st:1:39: found '5', expected an interval as T#10ms"},
        {"RESOURCE R ON Cpu TASK T (INTERVAL := TOD#1:02)",
         "m.st:1:39: found 'TOD#1:02', expected an interval as T#10ms"},
        {"RESOURCE R ON Cpu TASK T (PRIORITY := -1)",
         "m.st:1:39: found '-', expected a priority of 32 bits without a sign"},
        {"RESOURCE R ON Cpu TASK T (EACH := 1)",
         "m.st:1:27: found 'EACH', expected SINGLE, INTERVAL or PRIORITY"},
        {"RESOURCE R ON Cpu PROGRAM P : M (x;",
         "m.st:1:36: found the end of the text, expected ')'"},
    };
    for (const Mistake& mistake : mistakes) {
        CAPTURE(mistake.text);
        CHECK(problem_of(mistake.text) == mistake.problem);
    }
}

TEST_CASE("A text of declarations that is cut anywhere is a problem or a program (3-3-2)")
{
    CHECK(problem_of(sample).empty());
    std::size_t programs = 0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
        const std::string problem = problem_of(sample.substr(0, i));
        CAPTURE(i, problem);
        CHECK((problem.empty() || problem.starts_with("m.st:")));
        programs += problem.empty() ? 1U : 0U;
    }
    // Nothing at all, a byte order mark, pragmas, comments, and ends of blocks.
    CHECK(programs > 5);
    CHECK(programs < 60);
}

TEST_CASE("Limits of declarations hold (3-3-2)")
{
    DeclarationLimits limits;
    limits.max_text_size = 20;
    CHECK(problem_of("VAR_GLOBAL   END_VAR", limits).empty());
    CHECK(problem_of("VAR_GLOBAL    END_VAR", limits) == "m.st: is larger than 20 bytes");
    const std::string type = "TYPE A : INT := ";
    CHECK(problem_of(type + repeated("[", 32) + "1" + repeated("]", 32) + "; END_TYPE").empty());
    CHECK(problem_of(type + repeated("[", 33)) ==
          "m.st:1:49: has more than 32 aggregates and lists within one another");
    CHECK(problem_of(type + repeated("(X := ", 100'000)).find("has more than 32") !=
          std::string::npos);
    CHECK(problem_of(type + repeated("[2(", 100'000)).find("has more than 32") !=
          std::string::npos);
    CHECK(problem_of("TYPE A : " + repeated("ARRAY[0..1] OF ", 17)) ==
          "m.st:1:256: has more than 16 dimensions");
    // As long as a BrowseName can be (Part 3, 8.3), since it becomes one.
    CHECK(problem_of("VAR_GLOBAL " + std::string(512, 'x') + " : INT; END_VAR").empty());
    CHECK(problem_of("VAR_GLOBAL " + std::string(513, 'x') + " : INT; END_VAR")
              .find("expected a name of at most 512 bytes") != std::string::npos);
    CHECK(problem_of("RESOURCE R ON C PROGRAM P : M " + repeated("(", 1'000'000)) ==
          "m.st:1:1000031: found the end of the text, expected ')'");
    CHECK(problem_of(repeated("(*", 1'000'000)) ==
          "m.st:1:1: found a comment without an end, expected '*)'");
}

TEST_CASE("Names that share a long initial value are counted each (3-3-2)")
{
    DeclarationLimits limits;
    limits.max_memory = 1U << 20U;
    const std::string value = "[" + repeated("1,", 999) + "1]";
    CHECK(problem_of("VAR_GLOBAL a : A := " + value + "; END_VAR", limits).empty());
    CHECK(
        problem_of("VAR_GLOBAL a" + repeated(",b", 999) + " : A := " + value + "; END_VAR", limits)
            .find("takes more than 1048576 bytes of memory up to here") != std::string::npos);
}

} // namespace declaration_errors_test
