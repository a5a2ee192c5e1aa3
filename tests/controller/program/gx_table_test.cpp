#include <catch2/catch.hpp>

#include <string>

#include <busbar/controller/program_text.hpp>

#include "shown_program.hpp"

// Lists of global labels as GX Works exports them.

namespace gx_table_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

/// What is served of one label of a type.
std::string label(const std::string& type)
{
    const std::string list = "\"Line\"\n\"Class\"\t\"Label Name\"\t\"Data Type\"\t\"Constant\"\n"
                             "\"VAR_GLOBAL\"\t\"x\"\t\"" +
                             type + "\"\t\"\"\n";
    return controller::test::shown(read_program_text(list, "l.csv", {}, Unserved::LeaveOut));
}

Program read(const std::string& list)
{
    auto program = read_program_text(list, "l.csv", {}, Unserved::LeaveOut);
    REQUIRE(program);
    return *std::move(program);
}

} // namespace

TEST_CASE("Types of GX Works are those of IEC 61131-3")
{
    const auto [type, expected] = GENERATE(table<std::string, std::string>({
        {"Bit", "x BOOL"},
        {"bit", "x BOOL"},
        {"Word [Signed]", "x INT"},
        {"Word [Unsigned]/Bit String [16-bit]", "x WORD"},
        {"Double Word [Signed]", "x DINT"},
        {"Double Word [Unsigned]/Bit String [32-bit]", "x DWORD"},
        {"FLOAT [Single Precision]", "x REAL"},
        {"FLOAT [Double Precision]", "x LREAL"},
        {"Time", "x TIME"},
        {"String(32)", "x STRING(32)"},
        {"String [Unicode](8)", "x WSTRING(8)"},
        {"Word [Signed](0..9)", "x [0..9]INT"},
        {"Word [Signed](0..9,1..4)", "x [0..9][1..4]INT"},
        {"String(8)(0..1)", "x [0..1]STRING(8)"},
        {"ワード[符号付き](1..2)", "x [1..2]INT"},
        {"文字列(16)", "x STRING(16)"},
        {"INT(0..9)", "x [0..9]INT"},
        {"ARRAY [0..9] OF DINT", "x [0..9]DINT"},
    }));
    CHECK(label(type) == expected);
}

TEST_CASE("Labels of GX Works have values, places, addresses and comments")
{
    const Program program =
        read("Data Type,Label Name,Class,Initial Value,Constant,Device,Comment,Access from "
             "External Device\r\n"
             "Word [Signed],a,VAR_GLOBAL,-5,,D0,\"one, \"\"two\"\"\nthree\",1\r\n"
             "Word [Signed],b,VAR_GLOBAL_CONSTANT,7,H1F,,,0\r\n"
             ",,,,,,,\r\n"
             "Bit,c,VAR_GLOBAL_RETAIN,,,M0,,TRUE\r\n"
             "Bit,d,VAR_INPUT,,,,,1\r\n"
             "Bit,7e,VAR_GLOBAL,,,,,\r\n");
    REQUIRE(program.variables.size() == 3);
    const GlobalVariable& a = program.variables[0];
    CHECK(a.initial.value == Variant{std::int64_t{-5}});
    CHECK(a.address == "D0");
    CHECK(a.comment == "one, \"two\"\nthree");
    CHECK(a.publish == NetworkPublish::PublishOnly);
    CHECK(a.place.line == 2);
    const GlobalVariable& b = program.variables[1];
    CHECK((b.is_constant && b.initial.value == Variant{std::int64_t{31}}));
    CHECK(b.publish == NetworkPublish::Hidden);
    CHECK(b.place.line == 4);
    CHECK((program.variables[2].is_retained && program.variables[2].address == "M0"));
    REQUIRE(program.left_out.size() == 2);
    CHECK(program.left_out[0].declared.name == "d");
    CHECK(program.left_out[0].declared.publish == NetworkPublish::PublishOnly);
    CHECK(text(program.left_out[0].problem).starts_with("7:7: variable d: found 'VAR_INPUT'"));
    CHECK(program.left_out[1].declared.name == "7e");
}

TEST_CASE("Constants of GX Works are numbers in bounds, before their line too")
{
    const Program program = read("Class,Label Name,Data Type,Constant\n"
                                 "VAR_GLOBAL,a,Word [Signed](0..c_N-1),\n"
                                 "VAR_GLOBAL_CONSTANT,c_N,Word [Signed],K4\n"
                                 "VAR_GLOBAL,b,String(c_H),\n"
                                 "VAR_GLOBAL_CONSTANT,c_H,Word [Signed],H1F\n");
    REQUIRE(program.variables.size() == 4);
    CHECK(program.variables[0].type.dimensions[0].upper == 3);
    CHECK(program.variables[2].type.string_length == 31);
}

TEST_CASE("A list of GX Works without classes is a structure")
{
    const std::string members = "Label Name,Data Type,Initial Value,Comment\n"
                                "Pos,FLOAT [Double Precision],1.5,\nOn,Bit,,\n";
    auto program = read("ST_Axis\n" + members);
    REQUIRE(program.types.size() == 1);
    CHECK(program.types[0].name == "ST_Axis");
    REQUIRE(program.types[0].members.size() == 2);
    CHECK(program.types[0].members[0].initial.value == Variant{1.5});
    CHECK(program.types[0].members[1].place.line == 4);
    // Without a name in it the file's is taken.
    const auto named = read_program_text(members, "lists/Axis.csv");
    REQUIRE((named && named->types.size() == 1));
    CHECK(named->types[0].name == "Axis");
    // A member with a mistake leaves the structure out.
    program = read("ST_Axis\n" + members + "Bad,Word [Signed],1 +,\n");
    CHECK(program.types.empty());
    REQUIRE(program.left_out.size() == 1);
    CHECK(text(program.left_out[0].problem).starts_with("5:"));
    CHECK(program.left_out[0].declared.name == "ST_Axis");
}

TEST_CASE("A list of GX Works is refused as a whole if that is asked for")
{
    const auto refused = read_program_text("Label Name,Data Type\nx,INT\ny,\n", "l.csv");
    REQUIRE_FALSE(refused);
    CHECK(text(refused.error()).starts_with("l.csv:3:3: "));
    DeclarationLimits limits;
    limits.max_memory = 1'000;
    std::string list = "Label Name,Data Type\n";
    for (int i = 0; i < 100; ++i) {
        list += "x" + std::to_string(i) + ",INT\n";
    }
    const auto large = read_program_text(list, "l.csv", limits, Unserved::LeaveOut);
    REQUIRE_FALSE(large);
    CHECK(text(large.error()).find("takes more than 1000 bytes of memory") != std::string::npos);
}

} // namespace gx_table_test
