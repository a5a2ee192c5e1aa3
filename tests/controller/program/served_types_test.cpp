#include <catch2/catch.hpp>

#include <string>

#include <busbar/controller/declaration_reader.hpp>

#include "shown_program.hpp"

namespace served_types_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string read(const std::string& text, const DeclarationLimits& limits = {})
{
    return controller::test::shown(read_declarations(text, "m.st", limits, Unserved::LeaveOut));
}

/// What is served of the variables, which types come before.
std::string variables(const std::string& declarations, const std::string& types = "")
{
    return read("TYPE " + types + " END_TYPE VAR_GLOBAL " + declarations + " END_VAR");
}

struct Row {
    const char* text;
    const char* served;
};

} // namespace

TEST_CASE("Types of the 3rd edition are served")
{
    const Row row = GENERATE(values<Row>({
        {"a : LTIME := LTIME#1h2ns;", "a LTIME"},
        {"a : LTIME := LT#5us;", "a LTIME"},
        {"a : LTIME := T#5s;", "a LTIME"},
        {"a : LDATE := LDATE#2026-11-29;", "a LDATE"},
        {"a : LDATE := LD#2026-11-29;", "a LDATE"},
        {"a : LTOD := LTOD#06:00:00.000000001; b : LTIME_OF_DAY;",
         "a LTIME_OF_DAY; b LTIME_OF_DAY"},
        {"a : LDT := LDT#2026-11-29-06:00:00; b : LDATE_AND_TIME;",
         "a LDATE_AND_TIME; b LDATE_AND_TIME"},
        {"a : WSTRING; b : WSTRING[20] := \"x\"; c : WSTRING(3) := WSTRING#\"$00E4$D83D$DE00\";",
         "a WSTRING(255); b WSTRING(20); c WSTRING(3)"},
        {"a : WSTRING := \"$D83D\";", "- a found '\"$D83D\"', expected a text of UTF-8"},
        {"a : WSTRING := \"$D83D$00E4\";", "- a found '\"$D83D$00E4\"', expected a text of UTF-8"},
        {"a : WCHAR := WCHAR#\"x\"; b : CHAR := CHAR#'x';", "a WCHAR; b CHAR"},
        {"a : BIT := TRUE; b : ARRAY [0..3] OF BIT;", "a BOOL; b [0..3]BOOL"},
        // Characters are units of UTF-16: four of them here, in ten bytes of UTF-8.
        {"a : WSTRING[4] := \"\u6E29\u5EA6\U0001F600\";", "a WSTRING(4)"},
        {"a : WSTRING[3] := \"\u6E29\u5EA6\U0001F600\";",
         "- a has a text of 10 bytes, expected a value of WSTRING[3]"},
        {"a : WCHAR := \"ab\";", "- a has a text of 2 bytes, expected a value of WCHAR"},
        // These words are names, too.
        {"Bit : BOOL; Char : INT; LT : INT; LD : INT;", "Bit BOOL; Char INT; LT INT; LD INT"},
    }));
    CAPTURE(row.text);
    CHECK(variables(row.text) == row.served);
}

TEST_CASE("Aliases and subranges are served as what they stand for")
{
    const Row row = GENERATE(values<Row>({
        {"a : Level; b : ARRAY [1..2] OF Level;", "a INT{0..100}; b [1..2]INT{0..100}"},
        {"a : Wide;", "a WSTRING(8)"},
        {"a : Level := 101;", "- a has 101, expected a value of INT (0..100)"},
        {"a : UINT (10..4095) := 10;", "a UINT{10..4095}"},
    }));
    CAPTURE(row.text);
    CHECK(variables(row.text, "Level : INT (0..100); Wide : WSTRING[8];") == row.served);
}

TEST_CASE("Structures, unions and enumerations without a name are served")
{
    const Row row = GENERATE(values<Row>({
        {"a : STRUCT x : INT; y : BOOL; END_STRUCT;", "a (x INT, y BOOL)"},
        {"a : STRUCT x : INT := 5; END_STRUCT := (x := 6);", "a (x INT)"},
        {"a, b : STRUCT x : INT; END_STRUCT;", "a (x INT); b (x INT)"},
        {"a : ARRAY [0..1] OF STRUCT x : STRUCT y : INT; END_STRUCT; z : (On, Off); END_STRUCT;",
         "a [0..1](x (y INT), z (On=0 Off=1))"},
        {"a : (Idle, Run := 5) := Run;", "a (Idle=0 Run=5)"},
        {"a : (Idle, Run) USINT;", "a (Idle=0 Run=1)"},
        {"a : UNION x : DINT; y : REAL; END_UNION;", "a |x DINT, y REAL|"},
        {"a : STRUCT x : TON; END_STRUCT; b : INT;",
         "b INT; - a.STRUCT is of the type TON, which is not declared; "
         "- a is of the type a.STRUCT, which is left out"},
        {"a : STRUCT x : POINTER TO INT; END_STRUCT; b : INT;",
         "b INT; - a is of the type POINTER, which is not served"},
    }));
    CAPTURE(row.text);
    CHECK(variables(row.text) == row.served);
}

TEST_CASE("A type without a name is named after the declaration that it is in")
{
    const auto program =
        read_declarations("TYPE P : STRUCT m : ARRAY [0..1] OF (A, B); END_STRUCT END_TYPE\n"
                          "VAR_GLOBAL v : STRUCT m : UNION i : INT; END_UNION; END_STRUCT; END_VAR",
                          "m.st");
    REQUIRE(program);
    std::string names;
    for (const DerivedType& each : program->types) {
        names += each.name + " ";
    }
    CHECK(names == "P.m.ENUM P v.m.UNION v.STRUCT ");
}

TEST_CASE("Structures within one another are limited")
{
    DeclarationLimits limits;
    limits.max_depth = 3;
    const auto nested = [](int count) {
        std::string type = "INT";
        for (int i = 0; i < count; ++i) {
            type = "STRUCT a : " + type + "; END_STRUCT";
        }
        return "VAR_GLOBAL v : " + type + "; b : INT; END_VAR";
    };
    CHECK(read(nested(4), limits) == "v (a (a (a (a INT)))); b INT");
    CHECK(read(nested(5), limits) == "b INT; - v is within more than 3 structures");
    CHECK(read(nested(10'000), limits) == "b INT; - v is within more than 3 structures");
}

TEST_CASE("A structure that extends another one has its members first")
{
    const Row row = GENERATE(values<Row>({
        {"A : STRUCT x : INT; END_STRUCT B EXTENDS A : STRUCT y : BOOL; END_STRUCT",
         "v (x INT, y BOOL)"},
        // In any order, over several, and without members of its own.
        {"B EXTENDS C : STRUCT y : BOOL; END_STRUCT C EXTENDS A : STRUCT END_STRUCT "
         "A : STRUCT x : INT; END_STRUCT",
         "v (x INT, y BOOL)"},
        {"B EXTENDS A : STRUCT y : BOOL; END_STRUCT",
         "- B extends A, which is not declared or left out; "
         "- v is of the type B, which is left out"},
        {"A : STRUCT x : POINTER TO INT; END_STRUCT B EXTENDS A : STRUCT y : BOOL; END_STRUCT",
         "- A is of the type POINTER, which is not served; "
         "- B extends A, which is not declared or left out; "
         "- v is of the type B, which is left out"},
        {"A : INT; B EXTENDS A : STRUCT y : BOOL; END_STRUCT",
         "- B extends A, which is not a structure; - v is of the type B, which is left out"},
        {"A EXTENDS B : STRUCT x : INT; END_STRUCT B EXTENDS A : STRUCT y : BOOL; END_STRUCT",
         "- B extends itself; - A extends B, which is left out; "
         "- v is of the type B, which is left out"},
        {"B EXTENDS B : STRUCT y : BOOL; END_STRUCT",
         "- B extends itself; - v is of the type B, which is left out"},
        {"A : STRUCT y : INT; END_STRUCT B EXTENDS A : STRUCT y : BOOL; END_STRUCT",
         "- B is also the name of another member; - v is of the type B, which is left out"},
        {"A : STRUCT x : INT; END_STRUCT B EXTENDS A : INT;",
         "- B extends a type, which only a structure can; "
         "- v is of the type B, which is left out"},
    }));
    CAPTURE(row.text);
    CHECK(variables("v : B;", row.text) == row.served);
}

TEST_CASE("Inherited members count as memory")
{
    std::string text = "TYPE T0 : STRUCT m : INT; END_STRUCT\n";
    for (int i = 1; i < 2'000; ++i) {
        text += "T" + std::to_string(i) + " EXTENDS T" + std::to_string(i - 1) + " : STRUCT m" +
                std::to_string(i) + " : INT; END_STRUCT\n";
    }
    DeclarationLimits limits;
    limits.max_memory = 10'000'000;
    CHECK_THAT(read(text + "END_TYPE", limits), Catch::Contains("of memory"));
}

TEST_CASE("A namespace may be declared after what uses it")
{
    CHECK(read("VAR_GLOBAL a : Lib.T; b : Lib.Sub.U; c : Other.T; END_VAR\n"
               "NAMESPACE Lib TYPE T : INT; END_TYPE\n"
               "NAMESPACE Sub TYPE U : BOOL; END_TYPE END_NAMESPACE END_NAMESPACE") ==
          "a INT; b BOOL; - c is of the type Other.T, which is not declared");
    // Also as a base, and of a member, and beside a type without a name.
    CHECK(read("TYPE S EXTENDS Lib.B : STRUCT m : Lib.T; END_STRUCT END_TYPE\n"
               "VAR_GLOBAL s : S; lib : STRUCT m : INT; END_STRUCT; END_VAR\n"
               "NAMESPACE Lib TYPE T : INT; B : STRUCT b : T; END_STRUCT END_TYPE END_NAMESPACE") ==
          "s (b INT, m INT); lib (m INT)");
}

} // namespace served_types_test
