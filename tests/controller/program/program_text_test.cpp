#include <catch2/catch.hpp>

#include <string>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/program_text.hpp>

namespace program_text_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string object(const std::string& inside)
{
    return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n"
           "<TcPlcObject Version=\"1.1.0.1\" ProductVersion=\"3.1.4024.12\">\r\n" +
           inside + "\r\n</TcPlcObject>";
}

std::string list(const std::string& declarations)
{
    return object("  <GVL Name=\"GVL\" Id=\"{0}\">\r\n    <Declaration><![CDATA[" + declarations +
                  "]]></Declaration>\r\n  </GVL>");
}

std::string problem_of(const std::string& text, const std::string& name = "m.txt")
{
    const auto program = read_program_text(text, name);
    return program ? "" : busbar::text(program.error());
}

} // namespace

TEST_CASE("The format of a program is recognized by its content")
{
    const char* const text = GENERATE(
        "VAR_GLOBAL x : INT; END_VAR",
        "<TcPlcObject><GVL Name=\"G\"><Declaration><![CDATA[VAR_GLOBAL x : INT; "
        "END_VAR]]></Declaration></GVL></TcPlcObject>",
        "\xEF\xBB\xBF<?xml version=\"1.0\"?><!-- made by hand -->\n"
        "<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\"><instances><configurations>"
        "<configuration name=\"C\"><globalVars><variable name=\"x\"><type><INT/></type></variable>"
        "</globalVars></configuration></configurations></instances></project>",
        "<p:Project xmlns:p=\"www.iec.ch/public/TC65SC65BWG7TF10\"><p:Instances><p:Configuration>"
        "<p:Resource><p:GlobalVars><p:Variable name=\"x\"><p:Type><p:TypeName>INT</p:TypeName>"
        "</p:Type></p:Variable></p:GlobalVars></p:Resource></p:Configuration></p:Instances>"
        "</p:Project>");
    const char* const name = GENERATE("m.txt", "m.st", "m.TcGVL");
    CAPTURE(text, name);
    const auto program = read_program_text(text, name);
    if (!program) {
        FAIL(busbar::text(program.error()));
    }
    REQUIRE(program->variables.size() == 1);
    CHECK(program->variables[0].name == "x");
}

TEST_CASE("A file of a known format that is not read is told by that")
{
    const auto [text, found] = GENERATE(table<std::string, std::string>({
        {"PK\x03\x04 and so on", "found a ZIP archive"},
        {"{\n  \"variables\": []}", "found JSON"},
        {"<?xml version=\"1.0\"?><!-- a > b --><RSLogix5000Content SchemaRevision=\"1.0\"/>",
         "found <RSLogix5000Content>, an export of Studio 5000"},
        {"<UANodeSet/>", "found <UANodeSet>, an information model"},
        {"<Project><ItemGroup/></Project>", "found a list of files (.plcproj)"},
        {std::string{"\xFF\xFE<\0U\0A\0N\0o\0d\0e\0S\0e\0t\0/\0>\0", 26},
         "found <UANodeSet>, an information model"},
    }));
    CAPTURE(text);
    CHECK(problem_of(text).starts_with("m.txt:1:1: " + found));
}

TEST_CASE("A file that is of no format is told as what its name says")
{
    CHECK(problem_of("<a/>").find("found <a>, expected <project>") != std::string::npos);
    CHECK(problem_of("", "m.xml").find("is not well-formed XML") != std::string::npos);
    CHECK(problem_of("x").find("expected TYPE, VAR_GLOBAL") != std::string::npos);
    CHECK(problem_of("<").find("is not well-formed XML") != std::string::npos);
    CHECK(problem_of("<?xml").find("m.txt:1:1") != std::string::npos);
}

TEST_CASE("An object of TwinCAT has the places of its file")
{
    const auto program = read_program_text(
        list("{attribute 'qualified_only'}\r\nVAR_GLOBAL CONSTANT\r\n\tN : INT := 3; // many\r\n"
             "END_VAR\r\n{attribute 'OPC.UA.DA' := '1'}\r\nVAR_GLOBAL\r\n"
             "\ta : ARRAY [1..GVL.N] OF INT;\r\n\tt : TON;\r\n\tp : POINTER TO INT;\r\nEND_VAR"),
        "m.TcGVL", {}, Unserved::LeaveOut);
    REQUIRE(program);
    REQUIRE(program->variables.size() == 3);
    CHECK(program->variables[0].comment == "many");
    CHECK(program->variables[0].place.line == 6);
    CHECK(program->variables[0].place.column == 2);
    CHECK(program->variables[1].publish == NetworkPublish::PublishOnly);
    CHECK(program->variables[1].type.dimensions.at(0) == Bounds{1, 3});
    REQUIRE(program->left_out.size() == 1);
    CHECK(busbar::text(program->left_out[0].problem) ==
          "12:6: variable p: is of the type POINTER, which is not served");

    CHECK(problem_of(list("VAR_GLOBAL\r\n  x : ;\r\nEND_VAR"), "m.TcGVL") ==
          "m.TcGVL:5:7: found ';', expected a type");
}

TEST_CASE("Types and units of TwinCAT are read")
{
    const auto type = read_program_text(
        object("<DUT Name=\"Axis\" Id=\"{0}\"><Declaration><![CDATA[TYPE Axis :\r\nSTRUCT\r\n\tx : "
               "LREAL;\r\nEND_STRUCT\r\nEND_TYPE\r\n]]></Declaration></DUT>"),
        "Axis.TcDUT");
    REQUIRE(type);
    REQUIRE(type->types.size() == 1);
    CHECK(type->types[0].members.at(0).place.line == 5);

    const auto unit = read_program_text(
        object("<POU Name=\"Pump\" Id=\"{0}\" SpecialFunc=\"None\"><Declaration><![CDATA["
               "FUNCTION_BLOCK Pump EXTENDS Base\r\nVAR\r\n\tx : INT;\r\nEND_VAR\r\n]]>"
               "</Declaration><Implementation><ST><![CDATA[x := 1;]]></ST></Implementation>"
               "<Method Name=\"M\"><Declaration><![CDATA[METHOD M : INT]]></Declaration></Method>"
               "</POU>"),
        "Pump.TcPOU", {}, Unserved::LeaveOut);
    REQUIRE(unit);
    CHECK(unit->variables.empty());
    REQUIRE(unit->left_out.size() == 1);
    CHECK(unit->left_out[0].kind == LeftOut::Kind::Unit);
    CHECK(unit->left_out[0].declared.name == "Pump");
}

TEST_CASE("A table of variables of Sysmac Studio is read, with or without titles")
{
    const std::string titles =
        "Name\tData Type\tInitial Value\tAT\tRetain\tConstant\tNetwork Publish\tComment\r\n";
    const bool has_titles = GENERATE(true, false);
    const std::string table = (has_titles ? titles : "") +
                              "Speed\tINT\tN * 2\t%D100\tTrue\tFalse\tOutput\tin m/s\r\n"
                              "Trace\tARRAY[0..N] OF REAL\t\t\tFalse\tFalse\tPublish Only\t\r\n"
                              "\r\n"
                              "N\tINT\t4\t\tFalse\tTrue\tDo not publish\t\r\n"
                              "Pump\tPOINTER TO INT\t\t\tFalse\tFalse\tInput\t\r\n"
                              "Wrong\tINT\t1 2\t\tMaybe\tFalse\tInput\t";
    const auto program = read_program_text(table, "m.txt", {}, Unserved::LeaveOut);
    REQUIRE(program);
    REQUIRE(program->variables.size() == 3);
    const GlobalVariable& speed = program->variables[0];
    CHECK(speed.name == "Speed");
    CHECK(speed.initial.value == Variant{std::int64_t{8}});
    CHECK(speed.address == "%D100");
    CHECK(speed.is_retained);
    CHECK(speed.publish == NetworkPublish::Output);
    CHECK(speed.comment == "in m/s");
    CHECK(speed.place.line == (has_titles ? 2 : 1));
    CHECK(program->variables[1].publish == NetworkPublish::PublishOnly);
    CHECK(program->variables[1].type.dimensions.at(0) == Bounds{0, 4});
    CHECK(program->variables[2].is_constant);
    REQUIRE(program->left_out.size() == 2);
    const std::string line = has_titles ? "6" : "5";
    CHECK(busbar::text(program->left_out[0].problem) ==
          line + ":6: variable Pump: is of the type POINTER, which is not served");
    CHECK(program->left_out[0].declared.publish == NetworkPublish::Input);
    CHECK(
        busbar::text(program->left_out[1].problem).find("found 'Maybe', expected True or False") !=
        std::string::npos);
    CHECK(problem_of(table).find("m.txt:" + line + ":6: ") == 0);
}

TEST_CASE("Objects of TwinCAT without declarations are refused with their place")
{
    CHECK(problem_of("<TcPlcObject/>") ==
          "m.txt:1:1: found <TcPlcObject>, expected an object with a <Declaration> in it");
    CHECK(problem_of("<TcPlcObject><GVL><Declaration/></GVL></TcPlcObject>") ==
          "m.txt:1:1: found <TcPlcObject>, expected an object with a <Declaration> in it");
    CHECK(problem_of("<TcPlcObject><GVL>").find("is not well-formed XML") != std::string::npos);
    DeclarationLimits limits;
    limits.max_memory = 1'000;
    const auto program =
        read_program_text("<TcPlcObject>" + std::string(1'000, '<'), "m.txt", limits);
    REQUIRE_FALSE(program);
    CHECK(busbar::text(program.error()) == "m.txt:1:1: takes more than 1000 bytes of memory");
}

} // namespace program_text_test
