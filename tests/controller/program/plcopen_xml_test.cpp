#include <catch2/catch.hpp>

#include <busbar/controller/plcopen_xml.hpp>
#include <busbar/controller/program_initial.hpp>

namespace plcopen_xml_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

const std::string head = "<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">\n";

std::string problem_of(const std::string& text, const DeclarationLimits& limits = {})
{
    const auto program = read_plcopen_xml(text, "m.xml", limits);
    return program ? "" : busbar::text(program.error());
}

std::string types_in(const std::string& types)
{
    return head + "<types><dataTypes>" + types + "</dataTypes></types></project>";
}

std::string globals_in(const std::string& variables, const std::string& attributes = "")
{
    return head + "<instances><configurations><configuration name=\"C\">\n<globalVars" +
           attributes + ">" + variables + "</globalVars>" +
           "</configuration></configurations></instances></project>";
}

Program program_of(const std::string& text)
{
    auto program = read_plcopen_xml(text, "m.xml");
    if (!program) {
        FAIL(busbar::text(program.error()));
    }
    return std::move(*program);
}

std::string published(const std::string& words)
{
    return "<addData><data name=\"urn:busbar:network-publish\" handleUnknown=\"preserve\">"
           "<publish>" +
           words + "</publish></data></addData>";
}

std::string variable(const std::string& type, const std::string& more = "")
{
    return "<variable name=\"x\"><type>" + type + "</type>" + more + "</variable>";
}

} // namespace

TEST_CASE("A variable or a type of PLCopen XML that is not understood is left out")
{
    const std::string text = globals_in(
        "<variable name=\"p\"><type><pointer><baseType><INT/></baseType></pointer></type>" +
        published("input") + "</variable>" + variable("<INT/>"));
    const auto program = read_plcopen_xml(text, "m.xml", {}, Unserved::LeaveOut);
    REQUIRE(program);
    CHECK(program->variables.size() == 1);
    REQUIRE(program->left_out.size() == 1);
    const LeftOut& pointer = program->left_out.front();
    CHECK(pointer.kind == LeftOut::Kind::Variable);
    CHECK(pointer.declared.name == "p");
    CHECK(pointer.declared.publish == NetworkPublish::Input);
    CHECK(busbar::text(pointer.problem) ==
          "3:38: variable p: found <pointer>, expected a type that is known here");
    CHECK_FALSE(read_plcopen_xml(text, "m.xml"));
    const auto types =
        read_plcopen_xml(types_in("<dataType name=\"W\"><baseType><pointer/></baseType></dataType>"
                                  "<dataType name=\"T\"><baseType><INT/></baseType></dataType>"),
                         "m.xml", {}, Unserved::LeaveOut);
    REQUIRE(types);
    CHECK(types->types.size() == 1);
    REQUIRE(types->left_out.size() == 1);
    CHECK(types->left_out.front().kind == LeftOut::Kind::Type);
}

TEST_CASE("Data types of PLCopen XML become types (6-2-2)")
{
    const Program program = program_of(types_in(
        "<dataType name=\"Mode\"><baseType><enum><values><value name=\"Off\"/>"
        "<value name=\"On\" value=\"16#5\"/></values><baseType><INT/></baseType></enum></baseType>"
        "<initialValue><simpleValue value=\"Mode#On\"/></initialValue></dataType>\n"
        "<dataType name=\"Level\"><baseType><subrangeSigned><range lower=\"-5\" upper=\"10\"/>"
        "<baseType><INT/></baseType></subrangeSigned></baseType></dataType>\n"
        "<dataType name=\"Point\"><baseType><struct>"
        "<variable name=\"X\"><type><LREAL/></type><initialValue><simpleValue value=\"1.5\"/>"
        "</initialValue></variable>"
        "<variable name=\"S\"><type><string length=\"8\"/></type></variable>"
        "<variable name=\"Row\"><type><array><dimension lower=\"0\" upper=\"2\"/>"
        "<dimension lower=\"-1\" upper=\"1\"/><baseType><array><dimension lower=\"1\" upper=\"1\"/>"
        "<baseType><derived name=\"Level\"/></baseType></array></baseType></array></type>"
        "</variable></struct></baseType><documentation><p>where <b>&lt;it&gt;</b> is</p>"
        "</documentation></dataType>\n"
        "<dataType name=\"Either\"><baseType><union><variable name=\"A\"><type><WORD/></type>"
        "</variable></union></baseType></dataType>"
        "<dataType name=\"T\"><baseType><TOD/></baseType></dataType>"));
    REQUIRE(program.types.size() == 5);
    const DerivedType& mode = program.types[0];
    CHECK(mode.kind == DerivedType::Kind::Enumeration);
    CHECK(mode.enumerators.at(1).value == 5);
    CHECK(mode.initial.enumeration == "Mode");
    CHECK(mode.place.line == 2);
    CHECK(mode.place.column == 19);
    CHECK(program.types[1].alias.subrange == Bounds{-5, 10});
    const DerivedType& point = program.types[2];
    REQUIRE(point.members.size() == 3);
    CHECK(point.members[0].initial.value == Variant{1.5});
    CHECK(point.members[1].type.string_length == 8);
    CHECK(point.members[2].type.type_name == "Level");
    CHECK(point.members[2].type.dimensions == std::vector<Bounds>{{0, 2}, {-1, 1}, {1, 1}});
    CHECK(point.comment == "where <it> is");
    CHECK(program.types[3].kind == DerivedType::Kind::Union);
    CHECK(program.types[4].alias.elementary == ElementaryType::TimeOfDay);
    const auto types = ProgramTypes::create(program);
    REQUIRE(types);
    CHECK(check_initial_values(*types));
}

TEST_CASE("Global variables of PLCopen XML have their attributes (3-3-1)")
{
    const Program program = program_of(
        globals_in("<variable name=\"a\" address=\"%IX0.1\"><type><BOOL/></type></variable>\n" +
                       variable("<INT/>", published("Do not publish")) + variable("<DINT/>"),
                   " constant=\"true\" retain=\"false\" persistent=\"1\"> " + published("output") +
                       "<!-- -->\n<variable name=\"v\"><type><DT/></type>"
                       "</variable"));
    REQUIRE(program.variables.size() == 4);
    CHECK(program.variables[0].name == "v");
    CHECK(program.variables[0].place.line == 4);
    CHECK(program.variables[1].address == "%IX0.1");
    CHECK(program.variables[1].is_constant);
    CHECK(program.variables[1].is_retained);
    CHECK(program.variables[1].publish == NetworkPublish::Output);
    CHECK(program.variables[2].publish == NetworkPublish::Hidden);
    CHECK(program.variables[3].publish == NetworkPublish::Output);
}

TEST_CASE("Initial values of PLCopen XML are as those of declarations (6-2-2)")
{
    const auto initial_of = [](const std::string& value) {
        return program_of(
                   globals_in(variable("<INT/>", "<initialValue>" + value + "</initialValue>")))
            .variables.at(0)
            .initial;
    };
    CHECK(initial_of("<simpleValue value=\"T#5s\"/>").value == Variant{5'000.0});
    CHECK(initial_of("<simpleValue value=\"&apos;a&lt;b&apos;\"/>").value ==
          Variant{String{"a<b"}});
    const InitialValue list =
        initial_of("<arrayValue><value repetitionValue=\"3\"><simpleValue value=\"-1\"/></value>"
                   "<value><structValue><value member=\"X\"><simpleValue value=\"TRUE\"/></value>"
                   "</structValue></value></arrayValue>");
    REQUIRE(list.parts.size() == 2);
    CHECK(list.parts[0].repeat == 3);
    CHECK(list.parts[0].value == Variant{std::int64_t{-1}});
    CHECK(list.parts[1].parts.at(0).member == "X");
    CHECK(list.parts[1].parts.at(0).place.line == 3);
}

TEST_CASE("Tasks and programs of PLCopen XML are found where vendors have them (6-2-1)")
{
    const Program program = program_of(
        head +
        "<instances><configurations><configuration name=\"C\"><resource name=\"R\">"
        "<task name=\"Fast\" interval=\"T#1ms\" priority=\"4\">"
        "<pouInstance name=\"P\" typeName=\"Main\"/></task>"
        "<task name=\"Late\" interval=\"trigger\"/><pouInstance name=\"Q\" typeName=\"Idle\"/>"
        "<globalVars><variable name=\"a\"><type><INT/></type></variable></globalVars>"
        "</resource></configuration></configurations></instances>"
        "<addData><data name=\"application\"><resource name=\"S\">"
        "<task name=\"Slow\" interval=\"PT0.02S\"/>"
        "<globalVars><variable name=\"b\"><type><INT/></type></variable></globalVars>"
        "<addData><data name=\"union\"><union name=\"U\"><variable name=\"A\"><type><INT/></type>"
        "</variable></union></data></addData></resource></data></addData></project>");
    REQUIRE(program.tasks.size() == 3);
    CHECK(program.tasks[0].interval == "T#1ms");
    CHECK(program.tasks[0].priority == 4);
    CHECK(program.tasks[1].interval.empty());
    CHECK(program.tasks[2].interval == "T#0.02s");
    REQUIRE(program.instances.size() == 2);
    CHECK(program.instances[0].task == "Fast");
    CHECK(program.instances[0].type_name == "Main");
    CHECK(program.instances[1].task.empty());
    CHECK(program.variables.size() == 2);
    REQUIRE(program.types.size() == 1);
    CHECK(program.types[0].kind == DerivedType::Kind::Union);
}

TEST_CASE("Mistakes in PLCopen XML are told with place, found and expected (3-3-2)")
{
    const auto in_types = [](const std::string& type) {
        return problem_of(types_in("\n<dataType name=\"A\">" + type + "</dataType>"));
    };
    const auto in_variable = [](const std::string& type, const std::string& more = "") {
        return problem_of(globals_in("\n" + variable(type, more)));
    };
    CHECK(problem_of("<a") == "m.xml:1:2: is not well-formed XML: Error parsing start element tag");
    CHECK(problem_of("<a/>") == "m.xml:1:1: found <a>, expected <project> of PLCopen XML or "
                                "<Project> of IEC 61131-10");
    CHECK(problem_of("<p:project xmlns:p=\"urn:x\"/>") ==
          "m.xml:1:1: found the namespace 'urn:x', expected http://www.plcopen.org/xml/tc6_0201, "
          "tc6_0200, tc6.xsd or www.iec.ch/public/TC65SC65BWG7TF10");
    CHECK(problem_of("<p:project xmlns:p=\"http://www.plcopen.org/xml/tc6_0200\"/>").empty());
    CHECK(problem_of("<!DOCTYPE a><a/>") ==
          "m.xml:1:1: has a DOCTYPE, which PLCopen XML has no use for");
    CHECK(problem_of("<?xml version='1.0' encoding='utf-8'?><a>\xFF</a>") ==
          "m.xml:1:42: found a byte that is not UTF-8; expected a text that is, or the name of its "
          "encoding");
    CHECK(in_types("") == "m.xml:3:1: found <dataType>, expected a type in its <baseType>");
    CHECK(in_types("<baseType><pointer/></baseType>") ==
          "m.xml:3:30: found <pointer>, expected a type that is known here");
    CHECK(in_types("<baseType><derived/></baseType>") ==
          "m.xml:3:30: found <derived>, expected the attribute name");
    CHECK(in_types("<baseType><array><baseType><INT/></baseType></array></baseType>") ==
          "m.xml:3:30: found <array>, expected <dimension>");
    CHECK(in_types("<baseType><array><dimension lower=\"a\"/></array></baseType>") ==
          "m.xml:3:37: in <dimension>: found 'a', which is neither a constant nor a value of "
          "an enumeration that is declared here");
    CHECK(in_types("<baseType><array><dimension lower=\"2\" upper=\"1\"/></array></baseType>") ==
          "m.xml:3:37: found the bounds 2..1, expected the lower one first");
    CHECK(in_types("<baseType><subrangeSigned/></baseType>") ==
          "m.xml:3:30: found <subrangeSigned>, expected <range> and a type of whole numbers in its "
          "<baseType>");
    CHECK(in_types("<baseType><string length=\"0\"/></baseType>") ==
          "m.xml:3:30: found the length 0, expected one from 1 on");
    CHECK(in_types("<baseType><enum><values><value/></values></enum></baseType>") ==
          "m.xml:3:44: found <value>, expected the attribute name");
    CHECK(in_types("<baseType><enum><values><value name=\"a\" value=\"300\"/></values><baseType>"
                   "<USINT/></baseType></enum></baseType>") ==
          "m.xml:3:44: found the value 300, expected one of 32 bits with a sign and of the base "
          "type");
    CHECK(in_variable("") == "m.xml:4:1: found <variable>, expected a type in its <type>");
    CHECK(in_variable("<INT/>", "<initialValue/>") ==
          "m.xml:4:39: found <initialValue>, expected <simpleValue>, <arrayValue> or "
          "<structValue>");
    CHECK(in_variable("<INT/>", "<initialValue><simpleValue value=\"1 2\"/></initialValue>") ==
          "m.xml:4:53: in <simpleValue>: found '2', expected the end of the value");
    CHECK(in_variable("<INT/>", "<initialValue><simpleValue/></initialValue>") ==
          "m.xml:4:53: in <simpleValue>: found the end of the text, expected a value");
    CHECK(in_variable("<INT/>", published("all")) ==
          "m.xml:4:48: found a publish attribute that is not known, expected <publish> with none, "
          "publish only, input or output");
    CHECK(problem_of(globals_in("", " constant=\"maybe\"")) ==
          "m.xml:3:1: in <globalVars>: found 'maybe', expected true or false as the attribute "
          "constant");
    CHECK(problem_of(globals_in("<variable name=\"a\" address=\"5\"><type><INT/></type>"
                                "</variable>")) ==
          "m.xml:3:13: in <variable>: found '5', expected an address as %IX0.0");
}

TEST_CASE("PLCopen XML that is cut anywhere is a problem (3-3-2)")
{
    const std::string text =
        globals_in(variable("<array><dimension lower=\"0\" upper=\"1\"/><baseType><INT/></baseType>"
                            "</array>",
                            "<initialValue><arrayValue><value><simpleValue value=\"1\"/></value>"
                            "</arrayValue></initialValue>" +
                                published("input")));
    CHECK(problem_of(text).empty());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::string problem = problem_of(text.substr(0, i));
        CAPTURE(i, problem);
        CHECK(problem.starts_with("m.xml:"));
    }
}

TEST_CASE("Limits of PLCopen XML hold (3-3-2)")
{
    DeclarationLimits limits;
    limits.max_memory = 10'000;
    std::string many = head;
    for (int i = 0; i < 100; ++i) {
        many += "<a/>";
    }
    CHECK(problem_of(many + "</project>", limits) ==
          "m.xml:1:1: takes more than 10000 bytes of memory");
    std::string deep = head;
    std::string behind;
    for (int i = 0; i < 100'000; ++i) {
        deep += "<addData>";
        behind += "</addData>";
    }
    CHECK(problem_of(deep + behind + "</project>").find("has more than 32 elements around it") !=
          std::string::npos);
    std::string values;
    for (int i = 0; i < 40; ++i) {
        values += "<arrayValue><value>";
    }
    std::string ends;
    for (int i = 0; i < 40; ++i) {
        ends += "</value></arrayValue>";
    }
    CHECK(problem_of(
              globals_in(variable("<INT/>", "<initialValue>" + values + ends + "</initialValue>")))
              .find("has more than 32 values around it") != std::string::npos);
    limits = {};
    limits.max_text_size = 3;
    CHECK(problem_of("<a/>", limits) == "m.xml: is larger than 3 bytes");
}

} // namespace plcopen_xml_test
