#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/declaration_reader.hpp>

namespace left_out_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

using Checked = std::shared_ptr<const CheckedProgram>;

Configured<Checked> read(std::string_view text, Unserved unserved = Unserved::LeaveOut)
{
    return read_declarations(text, "m.st", {}, unserved).and_then([&](Program program) {
        return CheckedProgram::create(std::move(program), unserved);
    });
}

std::string served(const Program& program)
{
    std::string names;
    for (const GlobalVariable& each : program.variables) {
        names += (names.empty() ? "" : " ") + each.name;
    }
    return names;
}

/// The variables and passages that are left out, each with its reason.
std::vector<std::string> left_out(const Program& program)
{
    std::vector<std::string> all;
    for (const LeftOut& each : program.left_out) {
        if (each.kind == LeftOut::Kind::Variable || each.kind == LeftOut::Kind::Part) {
            all.push_back(text(each.problem));
        }
    }
    return all;
}

struct Row {
    const char* text;
    const char* served;
    /// Of the first variable or passage that is left out; empty if nothing is.
    const char* reason;
};

} // namespace

TEST_CASE("A declaration that is not served is left out with its reason, and no other")
{
    const Row row = GENERATE(values<Row>({
        {"VAR_GLOBAL a : INT; t : TON; b : INT; END_VAR", "a b",
         "1:21: variables[1] (t): is of the type TON, which is not declared"},
        {"VAR_GLOBAL a : INT; t : ARRAY [0..3] OF TON; b : INT; END_VAR", "a b",
         "1:21: variables[1] (t): is of the type TON, which is not declared"},
        {"VAR_GLOBAL p, q : POINTER TO INT; b : INT; END_VAR", "b",
         "1:19: variable p: is of the type POINTER, which is not served"},
        {"VAR_GLOBAL p : REFERENCE TO INT := x; b : INT; END_VAR", "b",
         "1:16: variable p: is of the type REFERENCE, which is not served"},
        {"VAR_GLOBAL f : Fb(retries := 3) := (a := 1); b : INT; END_VAR", "b",
         "1:16: variable f: is of the type Fb with arguments, which is not served"},
        {"VAR_GLOBAL f : Lib.Sub.Kind; b : INT; END_VAR", "b",
         "1:12: variables[0] (f): is of the type Lib.Sub.Kind, which is not declared"},
        {"VAR_GLOBAL s : STRUCT x : INT; y : ANY; END_STRUCT; b : INT; END_VAR", "b",
         "1:36: variable s: is of the type ANY, which is not served"},
        {"VAR_GLOBAL a : INT := 40000; b : INT; END_VAR", "b",
         "1:23: variables[0] (a): has 40000, expected a value of INT"},
        {"VAR_GLOBAL a : INT; A : BOOL; b : INT; END_VAR", "a b",
         "1:21: variables[1] (A): is also the name of another variable"},
        {"VAR_GLOBAL a : STRING := 'open; b : INT;\n c : INT; END_VAR", "c",
         "1:26: variable a: found a text without an end in its line, expected \"'\""},
        {"VAR_GLOBAL a : INT b : INT; c : INT; END_VAR", "c",
         "1:20: variable a: found 'b', expected ';'"},
        {"VAR_GLOBAL a : INT; VAR_GLOBAL c : INT; END_VAR", "a c",
         "1:21: text: found 'VAR_GLOBAL', expected the name of a variable or 'END_VAR'"},
        {"VAR_GLOBAL a : INT; END_RESOURCE VAR_GLOBAL b : INT; END_VAR", "a b",
         "1:21: text: found 'END_RESOURCE', expected the name of a variable or 'END_VAR'"},
        {"TYPE T : INT; END_VAR VAR_GLOBAL b : T; END_VAR", "b",
         "1:15: text: found 'END_VAR', expected the name of a type or 'END_TYPE'"},
        {"VAR_GLOBAL a : INT; b : ", "a",
         "1:25: variable b: found the end of the text, expected a type"},
        {"VAR_GLOBAL a : INT; END_VAR (* open", "a",
         "1:29: text: found a comment without an end, expected '*)'"},
        {"stray words; VAR_GLOBAL a : INT; END_VAR", "a",
         "1:1: text: found 'stray', expected TYPE, VAR_GLOBAL, CONFIGURATION or RESOURCE"},
    }));
    CAPTURE(row.text);
    const auto program = read(row.text);
    REQUIRE(program);
    CHECK(served((*program)->program()) == row.served);
    const std::vector<std::string> reasons = left_out((*program)->program());
    REQUIRE_FALSE(reasons.empty());
    CHECK(reasons.front() == row.reason);
    CHECK_FALSE(read(row.text, Unserved::Refuse));
}

TEST_CASE("A type that is not served takes what uses it along")
{
    const Row row = GENERATE(values<Row>({
        {"TYPE S : STRUCT a : INT; t : TON; END_STRUCT END_TYPE VAR_GLOBAL s : S; b : INT; END_VAR",
         "b", "1:66: variables[0] (s): is of the type S, which is left out"},
        {"TYPE S : STRUCT a : ANY; END_STRUCT R : STRUCT s : S; END_STRUCT; Q : ARRAY [0..1] OF R;"
         " T : INT; END_TYPE VAR_GLOBAL q : Q; t : T; END_VAR",
         "t", "1:119: variables[0] (q): is of the type Q, which is left out"},
        {"TYPE S EXTENDS B : STRUCT a : INT; b : STRUCT c : INT; END_STRUCT; END_STRUCT;\n"
         "T : INT; END_TYPE VAR_GLOBAL s : S; t : T; END_VAR",
         "t", "2:30: variables[0] (s): is of the type S, which is left out"},
        {"TYPE S : STRUCT s : R; END_STRUCT R : STRUCT s : S; END_STRUCT T : INT; END_TYPE\n"
         "VAR_GLOBAL s : S; t : T; END_VAR",
         "t", "2:12: variables[0] (s): is of the type S, which is left out"},
        {"TYPE S : INT; s : BOOL; END_TYPE VAR_GLOBAL a : S; END_VAR", "a", ""},
        {"TYPE E : (A, B, A); END_TYPE VAR_GLOBAL e : E; b : INT; END_VAR", "b",
         "1:41: variables[0] (e): is of the type E, which is left out"},
        {"TYPE S : STRUCT a : INT := 'x'; END_STRUCT END_TYPE VAR_GLOBAL s : S; b : INT; END_VAR",
         "b", "1:64: variables[0] (s): is of the type S, which is left out"},
        {"FUNCTION_BLOCK Fb VAR x : INT; END_VAR x := 1; END_FUNCTION_BLOCK\n"
         "VAR_GLOBAL f : Fb; b : INT; END_VAR",
         "b", "2:12: variables[0] (f): is of the type Fb, which is a function block"},
    }));
    CAPTURE(row.text);
    const auto program = read(row.text);
    REQUIRE(program);
    CHECK(served((*program)->program()) == row.served);
    const std::vector<std::string> reasons = left_out((*program)->program());
    CHECK((reasons.empty() ? "" : reasons.front()) == row.reason);
}

TEST_CASE("What only a whole program has is skipped")
{
    const char* const text = GENERATE(
        "PROGRAM Main VAR a : INT; END_VAR a.TYPE := a + 1; s := 'END_PROGRAM'; END_PROGRAM",
        "{attribute 'hide'} METHOD PUBLIC OVERRIDE Run : BOOL VAR_INPUT x : LREAL; END_VAR Run := "
        "x > 0; END_METHOD",
        "METHOD Count : INT; END_METHOD METHOD PRIVATE Clear Count := 0; END_METHOD",
        "PROPERTY PUBLIC Level : INT GET Level := 5; END_GET SET x := Level; END_SET END_PROPERTY",
        "ACTION Start: run := TRUE; END_ACTION",
        "FUNCTIONBLOCK Ramp VAR_INPUT x : REAL; END_VAR _LD_BODY _NETWORKS : 1 END_FUNCTION_BLOCK",
        "FUNCTION F : INT VAR_INPUT x : INT; END_VAR F := x; (* END_FUNCTION *) END_FUNCTION",
        "FUNCTION_BLOCK ABSTRACT B METHOD PUBLIC M : INT M := 1; END_METHOD END_FUNCTION_BLOCK",
        "INTERFACE I METHOD M : INT END_METHOD END_INTERFACE",
        "VAR_CONFIG Main.x AT %IX0.0 : BOOL; END_VAR",
        "CONFIGURATION C RESOURCE R ON P END_RESOURCE VAR_ACCESS A : R.x : INT READ_ONLY; END_VAR "
        "END_CONFIGURATION",
        "USING Lib.Sub;", "NAMESPACE Lib.Sub TYPE T : INT; END_TYPE END_NAMESPACE",
        // As development systems store the declarations of a unit: without its end.
        "FUNCTION_BLOCK B VAR_INPUT x : INT; END_VAR");
    CAPTURE(text);
    const auto program = read(std::string{text} + " VAR_GLOBAL a : INT; END_VAR");
    REQUIRE(program);
    CHECK(served((*program)->program()) == "a");
    CHECK(left_out((*program)->program()).empty());
}

TEST_CASE("A type of a namespace is found by its name and by that with the namespace")
{
    const auto program = read("NAMESPACE Lib TYPE T : INT; END_TYPE END_NAMESPACE\n"
                              "VAR_GLOBAL a : T; b : Lib.T; END_VAR");
    REQUIRE(program);
    CHECK(served((*program)->program()) == "a b");
}

TEST_CASE("A passage after declarations of several names is left out once")
{
    const auto program = read("VAR_GLOBAL a, b : INT; END_VAR stray");
    REQUIRE(program);
    CHECK(served((*program)->program()) == "a b");
    CHECK(left_out((*program)->program()).size() == 1);
}

TEST_CASE("A text of which nothing is understood is refused with its first mistake")
{
    const auto program = read("# Read me\n\nThis is no program.");
    REQUIRE_FALSE(program);
    CHECK(text(program.error()) ==
          "m.st:1:1: found '#', expected TYPE, VAR_GLOBAL, CONFIGURATION or RESOURCE");
    CHECK(read(""));
}

TEST_CASE("What is left out counts towards the memory that a text may take")
{
    std::string text = "VAR_GLOBAL\n";
    for (int i = 0; i < 1'000; ++i) {
        text += "a : POINTER TO INT;\n";
    }
    DeclarationLimits limits;
    limits.max_memory = 100'000;
    const auto program = read_declarations(text + "END_VAR", "m.st", limits, Unserved::LeaveOut);
    REQUIRE_FALSE(program);
    CHECK(busbar::text(program.error()).find("takes more than 100000 bytes of memory") !=
          std::string::npos);
}

TEST_CASE("A variable that is left out keeps whether it was to be published")
{
    const auto program = read("VAR_GLOBAL {attribute 'publish' := 'input'} a : TON; b : TON;\n"
                              "{attribute 'publish' := 'output'} c : REF_TO INT; d : ANY; END_VAR\n"
                              "{attribute 'publish' := 'publish only'} VAR_GLOBAL e : ANY; "
                              "END_VAR");
    REQUIRE(program);
    std::vector<std::string> names;
    for (const LeftOut& each : (*program)->program().left_out) {
        if (each.declared.publish != NetworkPublish::Hidden) {
            names.push_back(each.declared.name);
        }
    }
    std::sort(names.begin(), names.end());
    CHECK(names == std::vector<std::string>{"a", "c", "e"});
}

TEST_CASE("A brace within a text does not end a pragma")
{
    const auto program = read("VAR_GLOBAL {attribute 'displaymode' := 'a}b'} a : INT; {it's} b : "
                              "INT; END_VAR",
                              Unserved::Refuse);
    REQUIRE(program);
    CHECK(served((*program)->program()) == "a b");
}

TEST_CASE("Further semicolons after a declaration mean nothing")
{
    const auto program = read("TYPE A : STRUCT a : INT;; END_STRUCT;; B : INT;; END_TYPE;\n"
                              "VAR_GLOBAL ; a : A;; b : INT; END_VAR;;",
                              Unserved::Refuse);
    REQUIRE(program);
    CHECK(served((*program)->program()) == "a b");
}

TEST_CASE("Files of Automation Studio are read")
{
    const auto checked =
        read("(* globals *)\nVAR\n a : {REDUND_UNREPLICABLE} REAL := 0.5;\n b : T;\n"
             "END_VAR\nVAR CONSTANT\n N : USINT := 4;\nEND_VAR\n"
             "TYPE T : STRUCT\n x : ARRAY [0..N] OF INT;\n y : BOOL (* last *)\n"
             "END_STRUCT; END_TYPE\nFUNCTION_BLOCK F VAR local : INT; END_VAR "
             "END_FUNCTION_BLOCK\nVAR RETAIN c : INT; END_VAR");
    REQUIRE(checked);
    CHECK(served((*checked)->program()) == "a b N c");
    CHECK(left_out((*checked)->program()).empty());
    // Without leaving out, the text is that of the standard.
    CHECK_FALSE(read("VAR a : INT; END_VAR", Unserved::Refuse));
    CHECK_FALSE(read("TYPE T : STRUCT x : INT END_STRUCT END_TYPE", Unserved::Refuse));
}

TEST_CASE("A type with a problem costs those that use it no more than others")
{
    constexpr int members = 5'000;
    constexpr std::size_t users = 3'000;
    std::string declared = "TYPE Leaf : INT; Deep : ARRAY [0..0,0..0,0..0,0..0,0..0,0..0,0..0,0..0,"
                           "0..0] OF INT;\nBad : STRUCT ";
    for (int i = 0; i < members; ++i) {
        declared += "m" + std::to_string(i) + " : Leaf; ";
    }
    declared += "last : ARRAY [0..0,0..0,0..0,0..0,0..0,0..0,0..0,0..0] OF Deep; END_STRUCT;\n";
    for (std::size_t i = 0; i < users; ++i) {
        declared += "U" + std::to_string(i) + " : STRUCT b : Bad; END_STRUCT;\n";
    }
    const auto checked = read(declared + "A : STRUCT b : B; END_STRUCT; B : STRUCT a : A; "
                                         "END_STRUCT; END_TYPE");
    REQUIRE(checked);
    const std::vector<LeftOut>& gone = (*checked)->program().left_out;
    REQUIRE(gone.size() == users + 3);
    for (std::size_t i = 0; i <= users; ++i) {
        CHECK(gone[i].problem.text == "has more than 16 dimensions with those of its types");
    }
    CHECK(text(gone[users + 1].problem).find("(A): contains itself") != std::string::npos);
    CHECK(text(gone[users + 2].problem).find("(B): contains itself") != std::string::npos);
}

} // namespace left_out_test
