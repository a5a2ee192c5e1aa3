#include <catch2/catch.hpp>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/program_initial.hpp>

namespace program_initial_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string check(const Program& program)
{
    const auto types = ProgramTypes::create(program);
    if (!types) {
        return "types: " + text(types.error());
    }
    const auto checked = check_initial_values(*types);
    return checked ? "" : text(checked.error());
}

/// Of a variable `x` that is declared so, beside some types.
std::string problem_of(const std::string& declaration)
{
    const auto program =
        read_declarations("TYPE Mode : (Off, On); Other : (Left, On);\n"
                          "Level : INT (0..100); Deep : ULINT (5..10);\n"
                          "Point : STRUCT X, Y : INT; Name : STRING[5]; M : Mode; END_STRUCT;\n"
                          "Path : STRUCT Points : ARRAY[0..1] OF Point; END_STRUCT;\n"
                          "Either : UNION A : INT; B : REAL; END_UNION;\n"
                          "Row : ARRAY[1..3] OF INT; END_TYPE\n"
                          "VAR_GLOBAL x : " +
                              declaration + "; END_VAR",
                          "i.st");
    return program ? check(*program) : text(program.error());
}

struct Case {
    const char* declaration;
    const char* problem;
};

} // namespace

TEST_CASE("Initial values that are of their types (6-2-2)")
{
    for (const char* good : {
             "BOOL := TRUE",
             "BOOL := 1",
             "SINT := -128",
             "INT := 16#7FFF",
             "UINT := 65535",
             "LINT := -9223372036854775808",
             "ULINT := 18446744073709551615",
             "BYTE := 255",
             "LWORD := 16#FFFF_FFFF_FFFF_FFFF",
             "REAL := 5",
             "REAL := -3.4e38",
             "LREAL := 1e300",
             "TIME := T#-5s",
             "DATE := D#2026-11-24",
             "TOD := TOD#12:00",
             "STRING := ''",
             "DT := DT#2026-11-24-12:00:00",
             "STRING[5] := 'abcde'",
             "INT (0..5) := 5",
             "Level := 100",
             "Deep := 10",
             "Mode := on",
             "Mode := Mode#Off",
             "Row := [1, 2, 3]",
             "Row := [3(7)]",
             "Row := [1]",
             "Row := [2(), 5]",
             "ARRAY[0..1] OF Row := [1, 5(2)]",
             "ARRAY[0..1] OF Row := [[1], [2(3)]]",
             "ARRAY[0..1] OF Row := [2([1, 2, 3])]",
             "ARRAY[0..1, 0..1] OF Row := [[1, 2], [[3], 1()]]",
             "Point := (X := 1, Name := 'a', m := Mode#On)",
             "Point := (y := -1)",
             "Path := (Points := [(X := 1), (M := Off)])",
             "Either := (B := 1.5)",
             "Path := (Points := [2((X := 1))])",
         }) {
        const std::string declaration = good;
        CAPTURE(declaration);
        CHECK(problem_of(declaration).empty());
    }
}

TEST_CASE("Initial values that are not of their types (6-2-2)")
{
    constexpr Case cases[]{
        {"INT := 70000", "7:23: variables[0] (x): has 70000, expected a value of INT"},
        {"BOOL := 2", "7:24: variables[0] (x): has 2, expected a value of BOOL"},
        {"BYTE := -1", "7:24: variables[0] (x): has -1, expected a value of BYTE"},
        {"INT := 1.5", "7:23: variables[0] (x): has 1.5, expected a value of INT"},
        {"INT := TRUE", "7:23: variables[0] (x): has TRUE, expected a value of INT"},
        {"LINT := 9223372036854775808",
         "7:24: variables[0] (x): has 9223372036854775808, expected a value of LINT"},
        {"REAL := 1e39", "7:24: variables[0] (x): has 1e+39, expected a value of REAL"},
        {"REAL := T#5s", "7:24: variables[0] (x): has T#5000ms, expected a value of REAL"},
        {"TIME := 5.0", "7:24: variables[0] (x): has 5, expected a value of TIME"},
        {"DATE := TOD#12:00",
         "7:24: variables[0] (x): has a time of day, expected a value of DATE"},
        {"TOD := D#2026-11-24",
         "7:23: variables[0] (x): has 2026-11-24T00:00:00Z, expected a value of TIME_OF_DAY"},
        {"STRING[5] := 'abcdef'",
         "7:29: variables[0] (x): has a text of 6 bytes, expected a value of STRING[5]"},
        {"STRING := abc",
         "7:26: variables[0] (x): has the name abc, expected a value of STRING[255]"},
        {"STRING := 5", "7:26: variables[0] (x): has 5, expected a value of STRING[255]"},
        {"INT (0..5) := 6", "7:30: variables[0] (x): has 6, expected a value of INT (0..5)"},
        {"Level := -1", "7:25: variables[0] (x): has -1, expected a value of INT (0..100)"},
        {"Deep := 4", "7:24: variables[0] (x): has 4, expected a value of ULINT (5..10)"},
        {"Deep := 18446744073709551615", "7:24: variables[0] (x): has 18446744073709551615, "
                                         "expected a value of ULINT (5..10)"},
        {"Mode := Off2",
         "7:24: variables[0] (x): has the name Off2, expected the name of a value of Mode"},
        {"Mode := 'On'",
         "7:24: variables[0] (x): has a text of 2 bytes, expected the name of a value of Mode"},
        {"Mode := 7", "7:24: variables[0] (x): has 7, expected the name of a value of Mode"},
        {"Mode := Other#On", "7:24: variables[0] (x): has a value of Other, expected one of Mode"},
        {"INT := Other#Up", "7:23: variables[0] (x): has the name Up, expected a value of INT"},
        {"Row := 1", "7:23: variables[0] (x): has no list, expected one as [1, 2]"},
        {"Row := [1, 2, 3, 4]",
         "7:33: variables[0] (x): has a list of more than the 3 elements that there are"},
        {"Row := [4(0)]",
         "7:26: variables[0] (x): has a list of more than the 3 elements that there are"},
        {"Row := [1, 70000]", "7:27: variables[0] (x)[1]: has 70000, expected a value of INT"},
        {"Row := [2(0), [1]]", "7:30: variables[0] (x)[2]: has several values, expected one"},
        {"Row := (X := 1)", "7:23: variables[0] (x): has no list, expected one as [1, 2]"},
        {"ARRAY[0..1] OF Row := [[1, 2, 3, 4]]",
         "7:49: variables[0] (x)[0]: has a list of more than the 3 elements that there are"},
        {"ARRAY[0..1] OF Row := [[1], 2]",
         "7:44: variables[0] (x)[1]: has one value beside lists, expected another list"},
        {"ARRAY[0..1] OF Row := [7(0)]",
         "7:41: variables[0] (x): has a list of more than the 6 elements that there are"},
        {"Point := 5",
         "7:25: variables[0] (x): has no members, expected those of Point as (X := 1)"},
        {"Point := [1, 2]",
         "7:25: variables[0] (x): has no members, expected those of Point as (X := 1)"},
        {"Point := (Z := 1)", "7:31: variables[0] (x).Z: is not a member of Point"},
        {"Point := (X := 1, x := 2)", "7:39: variables[0] (x).x: has a second value"},
        {"Point := (Name := 'abcdef')",
         "7:34: variables[0] (x).Name: has a text of 6 bytes, expected a value of STRING[5]"},
        {"Path := (Points := [(X := 1), (M := Up)])",
         "7:52: variables[0] (x).Points[1].M: has the name Up, expected the name of a value of "
         "Mode"},
        {"Either := (A := 1, B := 2)",
         "7:26: variables[0] (x): has several members, expected one because Either is a union"},
        {"INT := [1]", "7:23: variables[0] (x): has several values, expected one"},
    };
    for (const Case& one : cases) {
        CAPTURE(one.declaration);
        CHECK(problem_of(one.declaration) == one.problem);
    }
}

TEST_CASE("Initial values of types and members are looked at, too (6-2-2)")
{
    const auto in_type = [](const std::string& types) {
        return check(*read_declarations("TYPE " + types + " END_TYPE", "t.st"));
    };
    CHECK(in_type("L : INT := 1; M : L := 2; E : (A, B) := B; P : STRUCT X : L := 3; END_STRUCT "
                  ":= (X := 4);")
              .empty());
    CHECK(in_type("L : SINT := 128;") == "1:18: types[0] (L): has 128, expected a value of SINT");
    CHECK(in_type("E : (A, B) := C;") ==
          "1:20: types[0] (E): has the name C, expected the name of a value of E");
    CHECK(in_type("P : STRUCT X : INT := 1; Y : INT := 1.5; END_STRUCT;") ==
          "1:42: types[0] (P).Y: has 1.5, expected a value of INT");
    CHECK(in_type("P : STRUCT X : INT; END_STRUCT := (Y := 1);") ==
          "1:46: types[0] (P).Y: is not a member of P");
}

TEST_CASE("Initial values of a vendor's table need no notation (6-2-2)")
{
    Program program;
    program.types = {{.name = "Mode",
                      .kind = DerivedType::Kind::Enumeration,
                      .enumerators = {{"Off", 0}, {"On", 1}}}};
    program.variables = {{.name = "x", .type = {.type_name = "Mode"}}};
    InitialValue& initial = program.variables[0].initial;
    initial.value = Variant{String{"On"}};
    CHECK(check(program).empty());
    initial.value = Variant{std::int32_t{1}};
    CHECK(check(program) == "variables[0] (x): has a value of another kind, expected the name of a "
                            "value of Mode");
    program.variables[0].type = {.elementary = ElementaryType::Time};
    initial.value = Variant{1.5};
    CHECK(check(program).empty());
    program.variables[0].type = {.elementary = ElementaryType::String, .string_length = 4};
    initial.value = Variant{String{"\xFF"}};
    CHECK(check(program) ==
          "variables[0] (x): has a text of 1 bytes, expected a value of STRING[4]");
    initial = {};
    initial.repeat = 2;
    initial.value = Variant{String{"a"}};
    CHECK(check(program) ==
          "variables[0] (x): is repeated, which only elements of an array can be");
    program.variables[0].type.dimensions = {{0, 3}};
    initial = {};
    initial.parts = {{.repeat = 0, .value = Variant{String{"a"}}}};
    CHECK(check(program) == "variables[0] (x)[0]: is repeated 0 times, expected 1 or more");
    initial.parts = {{.value = Variant{String{"a"}}}, {.member = "X"}};
    CHECK(check(program) ==
          "variables[0] (x)[1]: is for the member X, expected an element of an array");
}

} // namespace program_initial_test
