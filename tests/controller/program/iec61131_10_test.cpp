#include <catch2/catch.hpp>

#include <string>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/plcopen_xml.hpp>

namespace iec61131_10_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

std::string project(const std::string& types, const std::string& variables,
                    const std::string& attributes = "")
{
    return "<?xml version=\"1.0\"?>\n"
           "<Project xmlns=\"www.iec.ch/public/TC65SC65BWG7TF10\" "
           "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
           "xmlns:smcext=\"https://www.ia.omron.com/Smc\" schemaVersion=\"1\">\n"
           "<FileHeader companyName=\"OMRON Corporation\" productName=\"Sysmac Studio\"/>"
           "<Types><GlobalNamespace>" +
           types +
           "</GlobalNamespace></Types><Instances><Configuration name=\"C\">"
           "<Resource name=\"R\" resourceTypeName=\"\">\n<GlobalVars" +
           attributes + ">" + variables + "</GlobalVars></Resource></Configuration></Instances>" +
           "</Project>";
}

std::string declared(const std::string& name, const std::string& kind, const std::string& inside)
{
    return "<DataTypeDecl name=\"" + name + "\"><UserDefinedTypeSpec xsi:type=\"" + kind + "\">" +
           inside + "</UserDefinedTypeSpec></DataTypeDecl>";
}

std::string named(const std::string& type)
{
    return "<TypeName>" + type + "</TypeName>";
}

std::string array_of(const std::string& type, const std::string& lower, const std::string& upper)
{
    return "<InstantlyDefinedType xsi:type=\"ArrayTypeSpec\"><BaseType>" + type +
           "</BaseType><DimensionSpec dimensionNumber=\"1\"><IndexRange lower=\"" + lower +
           "\" upper=\"" + upper + "\"/></DimensionSpec></InstantlyDefinedType>";
}

std::string variable(const std::string& type, const std::string& more = "",
                     const std::string& before = "")
{
    return "<Variable name=\"x\">" + before + "<Type>" + type + "</Type>" + more + "</Variable>";
}

std::string published(const std::string& word)
{
    return "<AddData><Data name=\"smc\" handleUnknown=\"discard\">"
           "<smcext:GlobalVariableAdditionalProperties networkPublish=\"" +
           word + "\"/></Data></AddData>";
}

Program program_of(const std::string& text)
{
    auto program = read_plcopen_xml(text, "m.xml");
    if (!program) {
        FAIL(busbar::text(program.error()));
    }
    return std::move(*program);
}

GlobalVariable variable_of(const std::string& xml, const std::string& types = "")
{
    return program_of(project(types, xml)).variables.at(0);
}

} // namespace

TEST_CASE("Variables of IEC 61131-10 are read as Sysmac Studio writes them")
{
    const GlobalVariable speed = variable_of(variable(
        named("REAL"),
        "<InitialValue><SimpleValue value=\"1.5\"/></InitialValue><Address address=\"%W461.00\"/>",
        "<Documentation xsi:type=\"SimpleText\">in m/s</Documentation>" + published("Output")));
    CHECK(speed.name == "x");
    CHECK(speed.type.elementary == ElementaryType::Real);
    CHECK(speed.initial.value == Variant{1.5});
    CHECK(speed.address == "%W461.00");
    CHECK(speed.comment == "in m/s");
    CHECK(speed.publish == NetworkPublish::Output);
    CHECK(speed.place.line == 4);

    CHECK(variable_of(variable(named("INT"), "", published("PublishOnly"))).publish ==
          NetworkPublish::PublishOnly);
    CHECK(variable_of(variable(named("INT"), "", published("DoNotPublish"))).publish ==
          NetworkPublish::Hidden);
    CHECK(variable_of(variable(named("INT"))).publish == NetworkPublish::Hidden);
    CHECK(variable_of(variable(named("STRING[20]"))).type.string_length == 20);
    CHECK(variable_of(variable(named("Lib\\Axis"))).type.type_name == "Axis");

    const Program kept =
        program_of(project("", variable(named("INT")), " constant=\"true\" retain=\"true\""));
    CHECK(kept.variables.at(0).is_constant);
    CHECK(kept.variables.at(0).is_retained);
}

TEST_CASE("Arrays of IEC 61131-10 may be nested, with constants as bounds")
{
    const std::string constant =
        "</GlobalVars><GlobalVars constant=\"true\"><Variable name=\"N\"><Type>" + named("INT") +
        "</Type><InitialValue><SimpleValue value=\"4\"/></InitialValue></Variable>";
    const GlobalVariable one =
        variable_of(variable(array_of(array_of(named("INT"), "0", "N-1"), "-1", "1"),
                             "<InitialValue><ArrayValue><Value repetitionValue=\"2\"><SimpleValue "
                             "value=\"N\"/></Value></ArrayValue></InitialValue>") +
                    constant);
    REQUIRE(one.type.dimensions.size() == 2);
    CHECK(one.type.dimensions.at(0) == Bounds{-1, 1});
    CHECK(one.type.dimensions.at(1) == Bounds{0, 3});
    CHECK(one.initial.parts.at(0).repeat == 2);
    CHECK(one.initial.parts.at(0).value == Variant{std::int64_t{4}});
}

TEST_CASE("Types of IEC 61131-10 are structures, enumerations, arrays and other names")
{
    const std::string types =
        declared("Axis", "StructTypeSpec",
                 "<Member name=\"Position\"><Type>" + named("LREAL") +
                     "</Type></Member><Member name=\"Trace\"><Type>" +
                     array_of(named("INT"), "0", "4") + "</Type></Member>") +
        declared(
            "Mode", "EnumTypeWithNamedValueSpec",
            "<Enumerator name=\"Idle\" value=\"3\"/><Enumerator name=\"Run\" value=\"Idle+7\"/>"
            "<BaseType>" +
                named("DINT") + "</BaseType>") +
        declared("Color", "EnumTypeSpec",
                 "<Enumerator name=\"Red\"/><Enumerator name=\"Green\"/>") +
        "<NamespaceDecl name=\"Lib\">" +
        declared("Row", "ArrayTypeSpec",
                 "<BaseType>" + named("INT") +
                     "</BaseType><DimensionSpec dimensionNumber=\"1\"><IndexRange lower=\"1\" "
                     "upper=\"3\"/></DimensionSpec>") +
        "</NamespaceDecl>" +
        declared("Level", "SubrangeTypeSpec",
                 "<BaseType>" + named("INT") + "</BaseType><Range lower=\"0\" upper=\"100\"/>");
    const Program program = program_of(
        project(types, variable(named("Mode"), "<InitialValue><SimpleValue value=\"Mode#Run\"/>"
                                               "</InitialValue>")));
    REQUIRE(program.types.size() == 5);
    CHECK(program.types[0].kind == DerivedType::Kind::Structure);
    CHECK(program.types[0].members.at(1).type.dimensions.at(0) == Bounds{0, 4});
    CHECK(program.types[1].enumerators.at(1).value == 10);
    CHECK(program.types[2].enumerators.at(1).value == 1);
    CHECK(program.types[3].kind == DerivedType::Kind::Alias);
    CHECK(program.types[3].alias.dimensions.at(0) == Bounds{1, 3});
    CHECK(program.types[4].alias.subrange == Bounds{0, 100});
    const auto checked = CheckedProgram::create(program);
    REQUIRE(checked);
}

TEST_CASE("What IEC 61131-10 has and is not served is left out with its reason")
{
    const std::string text = project(
        "<FunctionBlock name=\"Pump\"><Vars><Variable name=\"y\"><Type>" + named("INT") +
            "</Type></Variable></Vars></FunctionBlock>" +
            declared("Ref", "ReferenceTypeSpec", "<BaseType>" + named("INT") + "</BaseType>"),
        "<Variable name=\"p\"><Type>" + named("Pump") + "</Type></Variable><Variable name=\"r\">" +
            "<Type>" + named("POINTER TO INT") + "</Type></Variable>" + variable(named("INT")));
    auto program = read_plcopen_xml(text, "m.xml", {}, Unserved::LeaveOut);
    REQUIRE(program);
    const auto checked = CheckedProgram::create(std::move(*program), Unserved::LeaveOut);
    REQUIRE(checked);
    REQUIRE((*checked)->program().variables.size() == 1);
    CHECK((*checked)->program().variables[0].name == "x");
    std::string reasons;
    for (const LeftOut& each : (*checked)->program().left_out) {
        reasons += busbar::text(each.problem) + "\n";
    }
    CHECK(reasons.find("(p): is of the type Pump, which is a function block") != std::string::npos);
    CHECK(reasons.find("variable r: in <TypeName>: is of the type POINTER, which is not served") !=
          std::string::npos);
    CHECK(reasons.find("type Ref: is a reference, which is not served") != std::string::npos);
}

TEST_CASE("PLCopen XML of versions 1.0 to 2.01 is read")
{
    const char* const version = GENERATE("tc6.xsd", "tc6_0101", "tc6_0200", "tc6_0201");
    CAPTURE(version);
    const Program program = program_of(
        "<project xmlns=\"http://www.plcopen.org/xml/" + std::string{version} +
        "\"><instances><configurations><configuration name=\"C\"><globalVars>"
        "<variable name=\"x\"><type><INT/></type></variable></globalVars></configuration>"
        "</configurations></instances></project>");
    CHECK(program.variables.size() == 1);
}

} // namespace iec61131_10_test
