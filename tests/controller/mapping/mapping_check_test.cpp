#include <busbar/controller/mapping_check.hpp>

#include "mapping_fixture.hpp"
#include "support/effort.hpp"

namespace mapping_check_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

/// A structure with the fields A (Int32) and B (Float[2]).
const std::string structure =
    "<UADataType NodeId=\"ns=1;s=S\" BrowseName=\"1:S\"><References>"
    "<Reference ReferenceType=\"i=45\" IsForward=\"false\">i=22</Reference></References>"
    "<Definition Name=\"1:S\"><Field Name=\"A\" DataType=\"i=6\"/>"
    "<Field Name=\"B\" DataType=\"i=10\" ValueRank=\"1\" ArrayDimensions=\"2\"/></Definition>"
    "</UADataType>\n"
    "<UAObject NodeId=\"ns=1;s=SB\" BrowseName=\"Default Binary\"><References>"
    "<Reference ReferenceType=\"i=38\" IsForward=\"false\">ns=1;s=S</Reference>"
    "<Reference ReferenceType=\"i=40\">i=76</Reference></References></UAObject>\n";

struct CheckFixture : ModelFixture {
    explicit CheckFixture(const std::string& nodes, const ModelLimits& limits = rd81opc96_model())
        : ModelFixture{limits}
    {
        import(file("urn:t", nodes));
    }
    [[nodiscard]] MappingCheck check() const { return check_mapping(models); }
};

/// The code and place of the first report about a node; nothing if there is none.
std::string first_report(const MappingCheck& check, const NodeId& node)
{
    for (const ModelReport& report : check.reports.list()) {
        if (report.node == node) {
            return std::to_string(static_cast<int>(report.code)) + ' ' + report.where;
        }
    }
    return {};
}

std::string one(const std::string& label)
{
    return "<DataMapping Data=\"" + label + "\"/>";
}

std::string array(const std::string& parts, const std::string& attributes = {})
{
    return "<DataMapping IsArray=\"true\" " + attributes + ">" + parts + "</DataMapping>";
}

std::string element(int number, const std::string& label = "x")
{
    return "<Element Num=\"" + std::to_string(number) + "\" Data=\"" + label + "\"/>";
}

} // namespace

TEST_CASE("9.5 Check: what fits a Variable and what does not", "[9.5][8.2]")
{
    struct Row {
        std::string attributes;
        std::string mapping;
        std::string expected;
    };
    const std::string int32 = "DataType=\"i=6\"";
    const std::string three = int32 + " ValueRank=\"1\" ArrayDimensions=\"3\"";
    const std::string open = int32 + " ValueRank=\"1\" ArrayDimensions=\"0\"";
    const std::string matrix = int32 + " ValueRank=\"2\" ArrayDimensions=\"2,3\"";
    const std::string of_structure = "DataType=\"ns=1;s=S\"";
    const std::vector<Row> rows{
        {int32, one("x"), ""},
        {"DataType=\"i=26\"", one("x"), "308 ns=1;s=V"}, // Number is abstract
        {int32, array(element(0)), "309 ns=1;s=V: [0]"},
        {three, array(element(0) + element(2)), ""},
        {three, array(element(3)), "309 ns=1;s=V: [3]"},
        {three, one("x"), "313 ns=1;s=V"},
        {three, array(element(0) + element(0)), "310 ns=1;s=V: [0]"},
        {three, array(element(0), "Rank=\"1\" Dim1=\"3\""), "312 ns=1;s=V"},
        {open, array(element(0)), ""},
        {open, array(element(1)), "309 ns=1;s=V: [1]"},
        {open, array(element(1), "Rank=\"1\" Dim1=\"2\""), ""},
        {open, array(element(0), "Rank=\"2\" Dim1=\"2\""), "311 ns=1;s=V"},
        {int32 + " ValueRank=\"-3\"", array(element(0), "Rank=\"2\""), "311 ns=1;s=V"},
        {int32 + " ValueRank=\"-3\"", "<DataMapping Data=\"x\" Rank=\"-1\"/>", ""},
        {int32 + " ValueRank=\"4\"", one("x"), "308 ns=1;s=V"},
        {matrix, array("<Element Num=\"1\">" + element(2) + "</Element>"), ""},
        {matrix, array(element(1)), "313 ns=1;s=V: [1]"},
        {matrix, array("<Element Num=\"1\">" + element(3) + "</Element>"), "309 ns=1;s=V: [1][3]"},
        {int32 + " ValueRank=\"2\" ArrayDimensions=\"1024,11\"", array(element(0)), "410 ns=1;s=V"},
        {of_structure,
         "<DataMapping IsStructure=\"true\"><Field Name=\"A\" Data=\"x\"/>"
         "<Field Name=\"B\" IsArray=\"true\">" +
             element(1) + "</Field></DataMapping>",
         ""},
        {of_structure,
         "<DataMapping IsStructure=\"true\"><Field Name=\"C\" Data=\"x\"/></DataMapping>",
         "309 ns=1;s=V: .C"},
        {of_structure,
         "<DataMapping IsStructure=\"true\"><Field Name=\"B\" Data=\"x\"/></DataMapping>",
         "313 ns=1;s=V: .B"},
        {of_structure,
         "<DataMapping IsStructure=\"true\"><Field Name=\"A\" Data=\"x\"/>"
         "<Field Name=\"A\" Data=\"y\"/></DataMapping>",
         "310 ns=1;s=V: .A"},
    };
    std::string nodes = structure;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        nodes +=
            variable("s=V" + std::to_string(i), extension(rows[i].mapping), rows[i].attributes);
    }
    const CheckFixture project{nodes};
    const MappingCheck check = project.check();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        CAPTURE(rows[i].attributes, rows[i].mapping);
        const std::string name = "V" + std::to_string(i);
        std::string expected = rows[i].expected;
        if (!expected.empty()) {
            expected.replace(expected.find('V'), 1, name);
        }
        CHECK(first_report(check, project.id(name)) == expected);
    }
}

TEST_CASE("9.5 Check: nodes that cannot be mapped", "[9.5]")
{
    CheckFixture project{cell() + variable("s=V") + method("s=M")};
    const auto code_of = [&](const NodeId& id) {
        Mapping& mapping = project.models.mapping();
        mapping = {};
        mapping.variables[id].value.label = "x";
        const MappingCheck check = project.check();
        REQUIRE(check.reports.list().size() == 1);
        CHECK(check.reports.list().front().node == id);
        return check.reports.list().front().code;
    };
    CHECK(code_of(project.id("X")) == ModelCode::NodeMissing);
    CHECK(code_of(NodeId{0, id::Server_ServerStatus_CurrentTime}) == ModelCode::StandardNode);
    CHECK(code_of(project.id("Cell")) == ModelCode::WrongNodeClass);
    CHECK(code_of(project.id("M")) == ModelCode::WrongNodeClass);
    // Another model requires the namespace.
    project.import(file("urn:u", variable("s=W"), required("urn:t"), "<Uri>urn:t</Uri>"));
    CHECK(code_of(project.id("V")) == ModelCode::RequiredNamespace);
}

/// Of the Method M: the number First, and an array of open length, Open.
std::string arguments_of_method(const std::string& browse_name)
{
    return "<UAVariable NodeId=\"ns=1;s=" + browse_name + "\" BrowseName=\"" + browse_name +
           "\" DataType=\"i=296\" "
           "ValueRank=\"1\" ArrayDimensions=\"2\"><References>"
           "<Reference ReferenceType=\"i=46\" IsForward=\"false\">ns=1;s=M</Reference>"
           "<Reference ReferenceType=\"i=40\">i=68</Reference></References><Value>"
           "<ListOfExtensionObject xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\">"
           "<ExtensionObject><TypeId><Identifier>i=297</Identifier></TypeId><Body><Argument>"
           "<Name>First</Name><DataType><Identifier>i=6</Identifier></DataType>"
           "<ValueRank>-1</ValueRank></Argument></Body></ExtensionObject>"
           "<ExtensionObject><TypeId><Identifier>i=297</Identifier></TypeId><Body><Argument>"
           "<Name>Open</Name><DataType><Identifier>i=6</Identifier></DataType>"
           "<ValueRank>1</ValueRank></Argument></Body></ExtensionObject>"
           "</ListOfExtensionObject></Value></UAVariable>";
}

TEST_CASE("9.5 Check: Methods", "[9.5]")
{
    CheckFixture project{cell() + method("s=M") + arguments_of_method("InputArguments")};
    MethodMapping& mapping = project.models.mapping().methods[project.id("M")];
    mapping.handle = "Start";
    mapping.arguments.push_back({.number = 0, .label = "First"});
    MappingCheck check = project.check();
    CAPTURE(lines(check.reports));
    CHECK(check.reports.is_empty());
    CHECK(check.counters.labels == 2);
    CHECK(check.counters.label_length == 10);
    CHECK(check.counters.variables == 0);
    mapping.arguments.push_back({.number = 2, .label = "x"});
    CHECK(has(project.check().reports, ModelCode::ArgumentUnknown));
    // Arrays of an open length cannot be arguments.
    mapping.arguments.back() = {.number = 1, .label = "x"};
    CHECK(has(project.check().reports, ModelCode::NotAssignable));
    mapping.arguments.back() = {.number = 0, .label = "x"};
    CHECK(has(project.check().reports, ModelCode::PartRepeated));
}

TEST_CASE("2.1 Check: Methods with OutputArguments", "[2.1]")
{
    CheckFixture project{cell() + method("s=M") + arguments_of_method("OutputArguments")};
    CHECK(project.check().reports.is_empty());
    project.models.mapping().methods[project.id("M")].handle = "Start";
    CHECK(has(project.check().reports, ModelCode::MethodHasOutputs));
}

TEST_CASE("8.2 Data types: those that no label can have", "[8.2][9.5]")
{
    std::string scalars;
    const std::vector<std::string> types{"i=14", "i=15", "i=16", "i=17", "i=18",
                                         "i=19", "i=20", "i=23", "i=25"};
    for (const std::string& type : types) {
        scalars += variable("s=" + type.substr(2), {}, "DataType=\"" + type + '"');
    }
    CheckFixture each{scalars};
    for (const std::string& type : types) {
        CAPTURE(type);
        each.models.mapping() = {};
        each.map(type.substr(2), "Speed");
        CHECK(has(each.check().reports, ModelCode::NotAssignable));
    }
    // As a field, and as an element.
    const std::string fields =
        "<UADataType NodeId=\"ns=1;s=T\" BrowseName=\"1:T\"><References>"
        "<Reference ReferenceType=\"i=45\" IsForward=\"false\">i=22</Reference></References>"
        "<Definition Name=\"1:T\"><Field Name=\"A\" DataType=\"i=6\"/>"
        "<Field Name=\"G\" DataType=\"i=14\"/></Definition></UADataType>\n";
    CheckFixture project{
        fields + variable("s=V", {}, "DataType=\"ns=1;s=T\"") +
        variable("s=W", {}, "DataType=\"i=14\" ValueRank=\"1\" ArrayDimensions=\"2\"")};
    MappedPart field{.kind = MappedPart::Kind::Field, .name = "A", .label = "Speed"};
    project.models.mapping().variables[project.id("V")].value.parts = {field};
    CAPTURE(lines(project.check().reports));
    CHECK_FALSE(has(project.check().reports, ModelCode::NotAssignable));
    field.name = "G";
    project.models.mapping().variables[project.id("V")].value.parts = {field};
    CHECK(has(project.check().reports, ModelCode::NotAssignable));
    project.models.mapping().variables.clear();
    project.models.mapping().variables[project.id("W")].value.parts = {
        {.kind = MappedPart::Kind::Element, .number = 1, .label = "Speed"}};
    CHECK(has(project.check().reports, ModelCode::NotAssignable));
}

TEST_CASE("4.2 Check: labels and limits", "[4.2][2.1]")
{
    ModelLimits limits = rd81opc96_model();
    CheckFixture project{variable("s=A") + variable("s=B"), limits};
    project.map("A", std::string(801, 'x'));
    CHECK(has(project.check().reports, ModelCode::LabelTooLong));
    project.map("A", "\u00E9t\u00E9");
    CHECK(project.check().counters.label_length == 3);
    const auto refuse = [](std::string_view label) -> std::optional<Problem> {
        return label == "bad" ? std::optional{Problem{}} : std::nullopt;
    };
    project.map("B", "bad");
    const MappingCheck check = check_mapping(project.models, refuse);
    REQUIRE(check.reports.list().size() == 1);
    CHECK(check.reports.list().front().code == ModelCode::LabelInvalid);
    CHECK(check.reports.list().front().node == project.id("B"));

    MappingCheckOptions options;
    options.limits.max_labels = 1;
    options.limits.max_total_label_length = 5;
    options.limits.max_variables = 1;
    options.limits.max_variable_words = 3;
    options.limits.max_node_levels = 0;
    options.limits.max_file_size = 9;
    options.file_size = 10;
    const ModelReports exceeded =
        check_mapping(project.models.space(), project.models.mapping(), options).reports;
    for (const ModelCode code :
         {ModelCode::TooManyLabels, ModelCode::LabelsTooLong, ModelCode::TooManyVariables,
          ModelCode::VariablesTooLarge, ModelCode::TooManyNodeLevels, ModelCode::FilesTooLarge}) {
        CAPTURE(static_cast<int>(code));
        CHECK(has(exceeded, code));
    }
}

TEST_CASE("2.1 Check: what the status bar counts", "[2.1][4.2]")
{
    CheckFixture project{structure + cell() + variable("s=Bool", {}, "DataType=\"i=1\"") +
                         variable("s=Text", {}, "DataType=\"i=12\"") +
                         variable("s=Byte", {}, "DataType=\"i=3\"") +
                         variable("s=Float", {}, "DataType=\"i=10\"") +
                         variable("s=Open", {}, "DataType=\"i=10\" ValueRank=\"1\"") +
                         variable("s=Ten", {},
                                  "DataType=\"i=6\" ValueRank=\"1\" "
                                  "ArrayDimensions=\"10\"")};
    MappingCheck check = project.check();
    CHECK(check.counters.variables == 6);
    CHECK(check.counters.variable_words == 1 + 256 + 2 + 4 + 0 + 20);
    CHECK(check.counters.labels == 0);
    CHECK(check.counters.file_size == project.models.file_size());
    MappedPart& open = project.models.mapping().variables[project.id("Open")].value;
    open.is_array = true;
    open.specification = {1, {5, 0, 0}};
    check = project.check();
    CHECK(check.counters.variable_words == 1 + 256 + 2 + 4 + 5 * 4 + 20);
}

TEST_CASE("2.1 Check: 50,000 nodes with 25,000 mapped Variables", "[2.1][9.4]")
{
    std::string nodes = cell();
    // As many as the product takes, unless time is short.
    const std::size_t mapped = test::is_full_effort() ? 25'000 : 2'500;
    for (std::size_t i = 0; i < mapped; ++i) {
        const std::string number = std::to_string(i);
        nodes += variable("s=V" + number, extension(one("Label" + number)));
        if (i != 0) {
            nodes += "<UAObject NodeId=\"ns=1;s=O" + number + "\" BrowseName=\"1:O" + number +
                     "\"><References><Reference ReferenceType=\"i=35\" IsForward=\"false\">"
                     "ns=1;s=Cell</Reference><Reference ReferenceType=\"i=40\">i=58</Reference>"
                     "</References></UAObject>";
        }
    }
    CheckFixture project{nodes};
    const MappingCheck check = project.check();
    CAPTURE(lines(check.reports));
    CHECK(check.reports.is_empty());
    CHECK(check.counters.labels == mapped);
    CHECK(check.counters.variables == mapped);
    CHECK(check.counters.variable_words == mapped * 2);
    const std::string exported = project.exported();
    ModelFixture again{rd81opc96_model()};
    const ImportResult result = again.import(exported);
    CHECK(result.node_count == 2 * mapped);
    CHECK(result.reports.is_empty());
    CHECK(count_labels(again.models.mapping()) == mapped);
}

TEST_CASE("2.1 Check: instances of types that the product does not support", "[2.1]")
{
    const std::string nodes =
        "<UAObjectType NodeId=\"ns=1;s=T\" BrowseName=\"1:T\"><References>"
        "<Reference ReferenceType=\"i=45\" IsForward=\"false\">i=15298</Reference></References>"
        "</UAObjectType>\n"
        "<UAObject NodeId=\"ns=1;s=W\" BrowseName=\"1:W\"><References>"
        "<Reference ReferenceType=\"i=40\">ns=1;s=T</Reference>"
        "<Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference></References>"
        "</UAObject>\n" +
        variable("s=R", "", "DataType=\"i=96\"") + variable("s=I", "", "DataType=\"i=6\"");
    CheckFixture project{nodes};
    const MappingCheck check = project.check();
    CAPTURE(lines(check.reports));
    REQUIRE(check.reports.list().size() == 2);
    CHECK(check.reports.warning_count() == 2);
    for (const ModelReport& each : check.reports.list()) {
        CHECK(each.code == ModelCode::TypeUnsupported);
    }
    CHECK(check.reports.list()[0].found == "T");
    CHECK(check.reports.list()[1].found == "RolePermissionType");
    CheckFixture any{nodes, ModelLimits{}};
    CHECK(any.check().reports.is_empty());
}

TEST_CASE("Check: a scaling is for numbers, and wants a range")
{
    const std::string eu_range =
        "<UAVariable NodeId=\"ns=1;s=R\" BrowseName=\"EURange\" DataType=\"i=884\"><References>"
        "<Reference ReferenceType=\"i=46\" IsForward=\"false\">ns=1;s=D</Reference>"
        "<Reference ReferenceType=\"i=40\">i=68</Reference></References><Value><ExtensionObject "
        "xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\"><TypeId><Identifier>i=885"
        "</Identifier></TypeId><Body><Range><Low>-50</Low><High>150</High></Range></Body>"
        "</ExtensionObject></Value></UAVariable>\n";
    CheckFixture project{variable("s=D", {}, "DataType=\"i=11\"") + eu_range +
                         variable("s=N", {}, "DataType=\"i=4\"") +
                         variable("s=T", {}, "DataType=\"i=12\"")};
    const auto found = [&](const std::string& name, const Scaling& scaling,
                           const std::string& quality = {}) {
        project.models.mapping().variables = {};
        DataMapping& mapping = project.models.mapping().variables[project.id(name)];
        mapping.value.label = "Label";
        mapping.scaling = scaling;
        mapping.quality = quality;
        return lines(project.check().reports);
    };
    CHECK(found("D", {0, 100, 0, 1}).empty());
    CHECK(found("D", {0, 100}, "Quality").empty());
    CHECK(found("N", {0, 100, 0, 1}).empty());
    CHECK(found("N", {0, 100}).find("M323 ns=1;s=N: Scaling: ") != std::string::npos);
    CHECK(found("N", {0, 100}).find("found 0..100 and no EURange, expected") != std::string::npos);
    CHECK(found("T", {0, 100, 0, 1}).find("found the DataType String, expected a number") !=
          std::string::npos);
    project.models.mapping().variables = {};
    project.models.mapping().variables[project.id("N")].quality = "Quality";
    CHECK(has(project.check().reports, ModelCode::QualityAlone));
}

TEST_CASE("Check: OutputArguments want a Handle and a Done")
{
    const std::string outputs =
        "<UAVariable NodeId=\"ns=1;s=O\" BrowseName=\"OutputArguments\" DataType=\"i=296\" "
        "ValueRank=\"1\" ArrayDimensions=\"1\"><References>"
        "<Reference ReferenceType=\"i=46\" IsForward=\"false\">ns=1;s=M</Reference>"
        "<Reference ReferenceType=\"i=40\">i=68</Reference></References><Value>"
        "<ListOfExtensionObject xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\">"
        "<ExtensionObject><TypeId><Identifier>i=297</Identifier></TypeId><Body><Argument>"
        "<Name>Out</Name><DataType><Identifier>i=4</Identifier></DataType><ValueRank>-1"
        "</ValueRank><ArrayDimensions/></Argument></Body></ExtensionObject>"
        "</ListOfExtensionObject></Value></UAVariable>\n";
    CheckFixture project{cell() + method("s=M") + outputs};
    MethodMapping& mapping = project.models.mapping().methods[project.id("M")];
    mapping.handle = "Start";
    CHECK(has(project.check().reports, ModelCode::MethodHasOutputs));
    mapping.done = "Ready";
    CHECK(project.check().reports.is_empty());
    mapping.outputs.push_back({.number = 0, .label = "Result"});
    CHECK(project.check().reports.is_empty());
    CHECK(project.check().counters.labels == 3);
    mapping.outputs.push_back({.number = 1, .label = "Result"});
    CHECK(has(project.check().reports, ModelCode::ArgumentUnknown));
    mapping.outputs.pop_back();
    mapping.handle.clear();
    CHECK(has(project.check().reports, ModelCode::MethodHasOutputs));
}

} // namespace mapping_check_test
