#include "product/machine/program_change.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <string>
#include <utility>

#include <busbar/controller/declaration_reader.hpp>

#include "product/machine/program_file.hpp"

namespace program_change_test {

// What differs between two programs.

using namespace busbar;
using namespace busbar::product;
using Catch::Matchers::StartsWith;

namespace {

controller::Program program(const std::string& text)
{
    auto read = controller::read_declarations(text, "press.st");
    INFO((read ? "" : busbar::text(read.error())));
    REQUIRE(read);
    return *std::move(read);
}

/// "variable Speed: INT | REAL", a line each: of the first and of the second.
std::string compared(const std::string& file, const std::string& controller)
{
    std::string all;
    for (const ProgramDifference& each : differences(program(file), program(controller))) {
        all += each.what + ": " + each.file + " | " + each.controller + "\n";
    }
    return all;
}

/// Of a text whose declarations may be left out.
controller::Program lenient_program(const std::string& text)
{
    auto read = read_program(text, "press.st", {.unserved = controller::Unserved::LeaveOut});
    INFO((read ? "" : busbar::text(read.error())));
    REQUIRE(read);
    return (*read)->program();
}

/// What is refused of the next program, which leaves out more; empty if it does not.
std::string left_out(const std::string& before, const std::string& next)
{
    const auto checked = check_left_out(lenient_program(before), lenient_program(next), "press.st");
    return checked ? "" : busbar::text(checked.error());
}

std::string global(const std::string& declarations)
{
    return "VAR_GLOBAL\n" + declarations + "\nEND_VAR\n";
}

} // namespace

TEST_CASE("program change: differences are told by name, whatever place or case")
{
    CHECK(compared(global("a : INT; b : BOOL;"), global("\n\nB : BOOL; A : INT; (* c *)")) == "");
    CHECK(compared(global("a : INT;"), global("a : REAL;")) == "variable a: INT | REAL\n");
    CHECK(compared(global("a : INT;"), global("")) == "variable a: INT | \n");
    CHECK(compared(global(""), global("a : INT := 7;")) == "variable a:  | INT := 7\n");
    CHECK(compared(global("a : ARRAY[0..3] OF STRING[9];"), global("a : STRING[10];")) ==
          "variable a: ARRAY[0..3] OF STRING[9] | STRING[10]\n");
    CHECK(compared(global("a : ARRAY[0..1] OF INT := [1, 2];"),
                   global("a : ARRAY[0..1] OF INT := [2(1)];")) ==
          "variable a: ARRAY[0..1] OF INT := (1, 2) | ARRAY[0..1] OF INT := (2 times 1)\n");
    CHECK(compared("VAR_GLOBAL RETAIN a : INT; END_VAR", global("a : INT;")) ==
          "variable a: INT, RETAIN | INT\n");
    CHECK(compared("VAR_GLOBAL CONSTANT a : BOOL := TRUE; END_VAR", global("a : BOOL := TRUE;")) ==
          "variable a: BOOL := TRUE, CONSTANT | BOOL := TRUE\n");
    CHECK(compared(global("{attribute 'publish' := 'publish only'} a : INT;"),
                   global("a : INT;")) == "variable a: INT, published | INT\n");
}

TEST_CASE("program change: types differ by what is in them")
{
    const auto type = [](const std::string& members) {
        return "TYPE Point : STRUCT " + members + " END_STRUCT END_TYPE\n";
    };
    CHECK(compared(type("x : INT; y : INT;"), type("x : INT; y : INT;")) == "");
    CHECK(compared(type("x : INT;"), type("x : REAL;")) ==
          "type Point: STRUCT x : INT | STRUCT x : REAL\n");
    CHECK(compared(type("x : INT;"), "TYPE Point : (On, Off); END_TYPE\n") ==
          "type Point: STRUCT x : INT | (On := 0, Off := 1)\n");
}

TEST_CASE("program change: tasks and instances are told by name, and take a download")
{
    controller::Program before;
    before.tasks = {{"Main", 4, "T#10ms"}, {"Slow", 8, "T#100ms"}};
    before.instances = {{"Press", "PressProgram", "Main"}};
    const std::array editions{controller::CheckedProgram::create(before).value()};
    CHECK(check_edit(editions, *editions.front()));
    const auto refusal = [&](auto edit) {
        controller::Program edited = before;
        edit(edited);
        const auto checked =
            check_edit(editions, *controller::CheckedProgram::create(edited).value());
        return checked ? "" : text(checked.error());
    };
    static const std::string end = "; this requires a download instead of an online edit";
    CHECK(refusal([](auto& p) { p.tasks[1].interval = "T#50ms"; }) ==
          "tasks (Slow): was different" + end);
    CHECK(refusal([](auto& p) { p.tasks.pop_back(); }) == "tasks (Slow): is gone" + end);
    CHECK(refusal([](auto& p) {
              p.tasks.push_back({"More", 1, ""});
          }) == "tasks (More): is new" + end);
    CHECK(refusal([](auto& p) { p.instances[0].task = "Slow"; }) ==
          "instances (Press): was different" + end);
    CHECK(refusal([](auto& p) { std::swap(p.tasks[0], p.tasks[1]); }) == "");
}

TEST_CASE("program change: what is left out now names the declaration that is new among others")
{
    const std::string before = global("a : INT;\nb : TON;\n5x : INT;");
    CHECK(left_out(before, before) == "");
    CHECK(left_out(before, global("5x : INT;\nb : TON;\nc : INT;")) == "");
    CHECK_THAT(left_out(before, global("a : TON;\nb : TON;\n5x : INT;")),
               StartsWith("press.st:2:1: variables[0] (a): "));
    // They have no names.
    CHECK_THAT(left_out(before, global("7y : INT;\nb : TON;\n5x : INT;")),
               StartsWith("press.st:2:1: text: found '7y'"));
    CHECK_THAT(left_out(before, global("5x : INT;\nb : TON;\n7y : INT;")),
               StartsWith("press.st:4:1: text: found '7y'"));
    CHECK(left_out(before, global("b : TON;\n7y : INT;")) == "");
}

} // namespace program_change_test
