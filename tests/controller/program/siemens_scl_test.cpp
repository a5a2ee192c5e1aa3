#include <catch2/catch.hpp>

#include <string>

#include <busbar/controller/declaration_reader.hpp>

#include "shown_program.hpp"

// Sources of TIA Portal: .udt, .db and .scl.

namespace siemens_scl_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string shown(const std::string& text, Unserved unserved = Unserved::LeaveOut)
{
    return controller::test::shown(read_declarations(text, "tia.scl", {}, unserved));
}

const std::string axis = "\xEF\xBB\xBFTYPE \"Axis\"\r\nVERSION : 0.1\r\n   STRUCT\r\n"
                         "      Pos { ExternalVisible := 'False'} : LReal;   // mm\r\n"
                         "      \"On Line\" : Bool;\r\n      Trace : Array[0..9] of Int;\r\n"
                         "      Name : String[20];\r\n   END_STRUCT;\r\n\r\nEND_TYPE\r\n";

} // namespace

TEST_CASE("Data blocks of TIA Portal are variables")
{
    struct Row {
        std::string text;
        std::string shown;
    };
    const Row row = GENERATE(
        Row{"DATA_BLOCK \"Line\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nNON_RETAIN\n"
            "STRUCT\n Speed : Real;\n \"Is On\" : Bool;\nEND_STRUCT;\n\nBEGIN\n Speed := 1.5;\n"
            "END_DATA_BLOCK\n",
            "Line (Speed REAL, Is On BOOL)"},
        Row{"DATA_BLOCK \"Line\"\nTITLE = Main\nAUTHOR : me\nVAR\n a : Int := 3;\nEND_VAR\nVAR "
            "RETAIN\n"
            " b : Word := W#16#FF;\nEND_VAR\nBEGIN\nEND_DATA_BLOCK",
            "Line (a INT, b WORD)"},
        Row{axis + "DATA_BLOCK \"Press 1\" VERSION : 0.1\n\"Axis\"\nBEGIN\nEND_DATA_BLOCK",
            "Press 1 (Pos LREAL, On Line BOOL, Trace [0..9]INT, Name STRING(20))"},
        Row{axis + "DATA_BLOCK \"A\" STRUCT a : Array[1..2] of \"Axis\"; END_STRUCT; BEGIN "
                   "a[1].Pos := 1.0; END_DATA_BLOCK",
            "A (a [1..2](Pos LREAL, On Line BOOL, Trace [0..9]INT, Name STRING(20))); -  is the "
            "start "
            "value of a part of a member, which is not read"},
        Row{"FUNCTION_BLOCK \"Ramp\"\nVERSION : 0.1\nVAR_INPUT In : Real; END_VAR\nBEGIN\n#Out := "
            "#In;\n"
            "END_FUNCTION_BLOCK\nDATA_BLOCK \"Ramp_DB\" \"Ramp\" BEGIN END_DATA_BLOCK\n"
            "DATA_BLOCK \"Next\" STRUCT n : Int; END_STRUCT; BEGIN END_DATA_BLOCK",
            "Next (n INT); - Ramp is a function block; - Ramp_DB is of the type Ramp, which is a "
            "function block"},
        Row{"DATA_BLOCK \"D\" STRUCT A : INT; END_STRUCT; BEGIN A.x := 'abc",
            "- D found a text without an end in its line, expected \"'\""},
        Row{"DATA_BLOCK \"D\" STRUCT A : INT; END_STRUCT; BEGIN A[1] := 1 END_DATA_BLOCK\n"
            "DATA_BLOCK \"Next\" STRUCT n : Int; END_STRUCT; BEGIN END_DATA_BLOCK",
            "Next (n INT); - D found 'END_DATA_BLOCK', expected ';'"},
        Row{"DATA_BLOCK \"Line\"\nTITLE = Main drive, it's 5 (* o'clock\nVERSION : 0.1\nVAR "
            "RETAIN\n"
            " Version : Int; Name, Title : Int;\nEND_VAR\nVAR DB_SPECIFIC NON_RETAIN\n"
            " Author : Int;\nEND_VAR\nBEGIN\nEND_DATA_BLOCK",
            "Line (Version INT, Name INT, Title INT, Author INT)"},
        Row{"DATA_BLOCK \"Line\"\nTITLE =\nVERSION : 0.1\nSTRUCT\n Family : Int;\nEND_STRUCT;\n"
            "BEGIN\nEND_DATA_BLOCK",
            "Line (Family INT)"},
        Row{"DATA_BLOCK \"T\" STRUCT n : Variant^; END_STRUCT; BEGIN END_DATA_BLOCK\n"
            "DATA_BLOCK \"Next\" STRUCT n : Int; END_STRUCT; BEGIN END_DATA_BLOCK",
            "Next (n INT); - T found '^', expected ';'"});
    CAPTURE(row.text);
    CHECK(shown(row.text) == row.shown);
}

TEST_CASE("A data block of TIA Portal begins with its start values")
{
    const auto program = read_declarations(
        "DATA_BLOCK \"D\" RETAIN STRUCT a : Int := 1; b : DInt; END_STRUCT; BEGIN b := L#-7; "
        "END_DATA_BLOCK\nDATA_BLOCK \"H\" { DB_Accessible_From_OPC_UA := 'FALSE' ; "
        "S7_Optimized_Access := 'TRUE' } READ_ONLY STRUCT a : Int; END_STRUCT; BEGIN "
        "END_DATA_BLOCK",
        "tia.db");
    REQUIRE(program);
    REQUIRE(program->variables.size() == 2);
    const GlobalVariable& first = program->variables[0];
    CHECK(first.is_retained);
    CHECK(first.publish == NetworkPublish::PublishOnly);
    REQUIRE(first.initial.parts.size() == 1);
    CHECK(first.initial.parts[0].member == "b");
    CHECK(first.initial.parts[0].value == Variant{std::int64_t{-7}});
    CHECK_FALSE(first.is_constant);
    CHECK(program->variables[1].is_constant);
    CHECK(program->variables[1].publish == NetworkPublish::Hidden);
}

TEST_CASE("A strict reader refuses what is wrong in a data block, with its place")
{
    const auto refused = read_declarations("DATA_BLOCK \"T\"\nSTRUCT\n n : Int\nEND_STRUCT;\n"
                                           "BEGIN\nEND_DATA_BLOCK",
                                           "tia.db");
    REQUIRE_FALSE(refused);
    CHECK(busbar::text(refused.error()) == "tia.db:4:1: found 'END_STRUCT', expected ';'");
    const auto no_end =
        read_declarations("DATA_BLOCK \"T\" STRUCT n : Int; END_STRUCT; BEGIN n := 1;", "tia.db");
    REQUIRE_FALSE(no_end);
    CHECK(busbar::text(no_end.error()).find("expected the name of a member or END_DATA_BLOCK") !=
          std::string::npos);
    const auto part = read_declarations(
        "DATA_BLOCK \"D\"\nSTRUCT A : INT; END_STRUCT;\nBEGIN\nA.x := 'abc", "tia.db");
    REQUIRE_FALSE(part);
    CHECK(busbar::text(part.error()) ==
          "tia.db:4:2: is the start value of a part of a member, which is not read");
}

} // namespace siemens_scl_test
