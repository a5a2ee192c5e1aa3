#include "mapping_fixture.hpp"

namespace mapping_extensions_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

/// What is read of a Variable "V" with this mapping, and of a Method "M".
struct ReadOne : ModelFixture {
    explicit ReadOne(const std::string& mapping, const ModelLimits& limits = {})
        : ModelFixture{limits}
    {
        const bool is_method = mapping.starts_with("<MethodMapping");
        result = import(file("urn:t", cell() + (is_method ? method("s=N", extension(mapping))
                                                          : variable("s=N", extension(mapping)))));
    }

    [[nodiscard]] const DataMapping* data() const
    {
        const auto found = models.mapping().variables.find(id("N"));
        return found == models.mapping().variables.end() ? nullptr : &found->second;
    }
    [[nodiscard]] const MethodMapping* method_mapping() const
    {
        const auto found = models.mapping().methods.find(id("N"));
        return found == models.mapping().methods.end() ? nullptr : &found->second;
    }

    ImportResult result;
};

/// The labels of a part with their paths: "[0].A=x".
std::string labels(const MappedPart& part, const std::string& path = {})
{
    std::string all = part.label.empty() ? "" : path + '=' + part.label + ' ';
    for (const MappedPart& inner : part.parts) {
        all += labels(inner, part_path(path, inner));
    }
    return all;
}

struct Case {
    std::string mapping;
    ModelCode code;
    /// What is left; "-" if nothing is.
    std::string left;
};

} // namespace

TEST_CASE("A-8 Format: the examples of DataMapping", "[A-8]")
{
    const std::string two_by_two =
        "<Element Num=\"0\"><Element Num=\"0\" Data=\"a\"/><Element Num=\"1\" Data=\"b\"/>"
        "</Element><Element Num=\"1\"><Element Num=\"0\" Data=\"c\"/></Element>";
    const std::string fields = "<Field Name=\"A\" Data=\"x\"/><Field Name=\"B\" Data=\"y\"/>";
    const std::vector<std::pair<std::string, std::string>> cases{
        {"<DataMapping Data=\"label01\"/>", "=label01 "},
        {"<DataMapping IsArray=\"true\"><Element Num=\"0\" Data=\"a\"/></DataMapping>", "[0]=a "},
        {"<DataMapping isArray=\"TRUE\">" + two_by_two + "</DataMapping>",
         "[0][0]=a [0][1]=b [1][0]=c "},
        {"<DataMapping IsArray=\"true\" Rank=\"3\"><Element Num=\"1\"><Element Num=\"2\">"
         "<Element Num=\"3\" Data=\"z\"/></Element></Element></DataMapping>",
         "[1][2][3]=z "},
        {"<DataMapping IsStructure=\"true\">" + fields + "</DataMapping>", ".A=x .B=y "},
        {"<DataMapping isStructure=\"true\"><Field Name=\"S\" IsStructure=\"true\">" + fields +
             "</Field></DataMapping>",
         ".S.A=x .S.B=y "},
        {"<DataMapping IsArray=\"true\" IsStructure=\"true\"><Element Num=\"1\">" + fields +
             "</Element></DataMapping>",
         "[1].A=x [1].B=y "},
        {"<DataMapping IsStructure=\"true\"><Field Name=\"F\" IsArray=\"true\" Rank=\"1\" "
         "Dim1=\"2\"><Element Num=\"0\" Data=\"a\"/></Field></DataMapping>",
         ".F[0]=a "},
    };
    for (const auto& [mapping, expected] : cases) {
        CAPTURE(mapping);
        const ReadOne read{mapping};
        CAPTURE(lines(read.result.reports));
        CHECK(read.result.reports.is_empty());
        REQUIRE(read.data() != nullptr);
        CHECK(labels(read.data()->value) == expected);
    }
}

TEST_CASE("A-8 Format: the examples of MethodMapping", "[A-8]")
{
    const ReadOne read{
        "<MethodMapping><Handle Data=\"Start\"/><Input>"
        "<Argument Num=\"2\" Data=\"c\"/>"
        "<Argument Num=\"0\" IsArray=\"true\" IsStructure=\"true\"><Element Num=\"0\">"
        "<Field Name=\"A\" Data=\"a\"/></Element></Argument></Input></MethodMapping>"};
    CAPTURE(lines(read.result.reports));
    CHECK(read.result.reports.is_empty());
    REQUIRE(read.method_mapping() != nullptr);
    const MethodMapping& mapping = *read.method_mapping();
    CHECK(mapping.handle == "Start");
    REQUIRE(mapping.arguments.size() == 2);
    CHECK(mapping.arguments[0].number == 0);
    CHECK(labels(mapping.arguments[0]) == "[0].A=a ");
    CHECK(mapping.arguments[1].number == 2);
    CHECK(mapping.arguments[1].label == "c");
}

TEST_CASE("A-8 Attributes: what is missing, unknown or impossible is reported", "[A-8]")
{
    const auto array = [](const std::string& element) {
        return "<DataMapping IsArray=\"true\"><Element Num=\"1\" Data=\"k\"/>" + element +
               "</DataMapping>";
    };
    const auto structure = [](const std::string& field) {
        return "<DataMapping IsStructure=\"true\">" + field + "</DataMapping>";
    };
    const std::vector<Case> cases{
        // Required: the part counts as not written (notes 1 and 3).
        {array("<Element Data=\"x\"/>"), ModelCode::AttributeMissing, "[1]=k "},
        {array("<Element Num=\"10240\" Data=\"x\"/>"), ModelCode::AttributeInvalid, "[1]=k "},
        {array("<Element Num=\"-1\" Data=\"x\"/>"), ModelCode::AttributeInvalid, "[1]=k "},
        {array("<Element Num=\" \" Data=\"x\"/>"), ModelCode::AttributeInvalid, "[1]=k "},
        {structure("<Field Data=\"x\"/>"), ModelCode::AttributeMissing, ""},
        {structure("<Field Name=\"\" Data=\"x\"/>"), ModelCode::AttributeInvalid, ""},
        // One that there is none of (note 2).
        {"<DataMapping Data=\"x\" Label=\"y\"/>", ModelCode::AttributeUnknown, "-"},
        {"<DataMapping data=\"x\"/>", ModelCode::AttributeUnknown, "-"},
        {array("<Element Num=\"2\" Data=\"x\" num=\"3\"/>"), ModelCode::AttributeUnknown, "[1]=k "},
        // Optional: left out (note 3).
        {"<DataMapping Data=\"x\" Rank=\"4\"/>", ModelCode::ValueOmitted, "=x "},
        {"<DataMapping Data=\"x\" Rank=\"0\"/>", ModelCode::ValueOmitted, "=x "},
        {"<DataMapping Data=\"" + std::string(801, 'x') + "\"/>", ModelCode::ValueOmitted, ""},
        // A label where none belongs (note 5).
        {"<DataMapping Data=\"x\" IsArray=\"true\"><Element Num=\"0\" Data=\"a\"/></DataMapping>",
         ModelCode::LabelMisplaced, "[0]=a "},
        {array("<Element Num=\"0\" Data=\"x\"><Element Num=\"0\" Data=\"a\"/></Element>"),
         ModelCode::LabelMisplaced, "[1]=k [0][0]=a "},
        {structure("<Field Name=\"F\" Data=\"x\" IsArray=\"true\"><Element Num=\"0\" Data=\"a\"/>"
                   "</Field>"),
         ModelCode::LabelMisplaced, ".F[0]=a "},
        {structure("<Field Name=\"F\" Data=\"x\" IsStructure=\"true\"/>"),
         ModelCode::LabelMisplaced, ""},
        // What does not keep to the format takes the whole mapping along.
        {"<DataMapping><Element Num=\"0\" Data=\"x\"/></DataMapping>", ModelCode::ElementUnknown,
         "-"},
        {"<DataMapping IsArray=\"true\"><element Num=\"0\"/></DataMapping>",
         ModelCode::ElementUnknown, "-"},
        {"<DataMapping Data=\"x\">text</DataMapping>", ModelCode::FormatInvalid, "-"},
        {array("<Element Num=\"2\"><Element Num=\"0\"><Element Num=\"0\"><Element Num=\"0\"/>"
               "</Element></Element></Element>"),
         ModelCode::ElementUnknown, "-"},
        {"<dataMapping Data=\"x\"/>", ModelCode::ElementUnknown, "-"},
        {"<MethodMapping/>", ModelCode::WrongNodeClass, "-"},
    };
    for (const Case& each : cases) {
        CAPTURE(each.mapping);
        ModelFixture fixture{rd81opc96_model()};
        const ImportResult result =
            fixture.import(file("urn:t", variable("s=N", extension(each.mapping))));
        CAPTURE(lines(result.reports));
        CHECK(has(result.reports, each.code));
        const auto found = fixture.models.mapping().variables.find(fixture.id("N"));
        const bool is_there = found != fixture.models.mapping().variables.end();
        CHECK((is_there ? labels(found->second.value) : "-") == each.left);
    }
}

TEST_CASE("A-8 Attributes: those that mean nothing where they stand are passed over", "[A-8]")
{
    const ReadOne read{"<DataMapping Num=\"x\" Name=\"y\" IsArray=\"true\">"
                       "<Element Num=\"0\" Data=\"a\" isArray=\"true\" Rank=\"9\" Sign=\"s\"/>"
                       "</DataMapping>"};
    CHECK(read.result.reports.is_empty());
    REQUIRE(read.data() != nullptr);
    const MappedPart& element = read.data()->value.parts.at(0);
    CHECK_FALSE(element.is_array);
    CHECK(element.specification == ArraySpecification{});
}

TEST_CASE("A-8 Attributes: Handle must have Data and the other parts of a Method none of it",
          "[A-8]")
{
    const ReadOne without{"<MethodMapping Data=\"x\"><Handle/><Input Data=\"y\">"
                          "<Argument Num=\"0\" Data=\"a\" Rank=\"1\"/></Input></MethodMapping>"};
    CHECK(has(without.result.reports, ModelCode::AttributeMissing));
    REQUIRE(without.method_mapping() != nullptr);
    CHECK(without.method_mapping()->handle.empty());
    CHECK(without.method_mapping()->arguments.at(0).specification == ArraySpecification{});
    const ReadOne without_number{"<MethodMapping><Handle Data=\"h\"/><Input>"
                                 "<Argument Data=\"a\"/></Input></MethodMapping>"};
    CHECK(has(without_number.result.reports, ModelCode::AttributeMissing));
    REQUIRE(without_number.method_mapping() != nullptr);
    CHECK(without_number.method_mapping()->arguments.empty());
}

TEST_CASE("A-8 Attributes: dimensions need a rank and few enough elements", "[A-8]")
{
    struct Row {
        std::string attributes;
        ArraySpecification expected;
    };
    const std::vector<Row> rows{
        {"Rank=\"1\" Dim1=\"3\"", {1, {3, 0, 0}}},
        {"Rank=\"2\" Dim1=\"2\" Dim2=\"3\"", {2, {2, 3, 0}}},
        {"Rank=\"-1\"", {-1, {}}},
        {"Dim1=\"3\"", {}},                                            // note 6
        {"Rank=\"1\" Dim1=\"10241\"", {1, {}}},                        // note 7
        {"Rank=\"1\" Dim1=\"10240\"", {1, {10'240, 0, 0}}},            //
        {"Rank=\"2\" Dim1=\"1024\" Dim2=\"11\"", {2, {}}},             // the product
        {"Rank=\"1\" Dim1=\"1024\" Dim2=\"11\"", {1, {1'024, 11, 0}}}, // of valid dimensions only
        {"Rank=\"2\" Dim1=\"10241\" Dim2=\"3\"", {2, {0, 3, 0}}},
    };
    for (const Row& row : rows) {
        CAPTURE(row.attributes);
        const ReadOne read{"<DataMapping IsArray=\"true\" " + row.attributes +
                               "><Element Num=\"0\" Data=\"a\"/></DataMapping>",
                           rd81opc96_model()};
        REQUIRE(read.data() != nullptr);
        CHECK(read.data()->value.specification == row.expected);
    }
}

TEST_CASE("A-8 xmlns: counts in the Extension only, and others' extensions are left alone", "[A-8]")
{
    const std::string uri{mapping_namespace};
    const auto import = [&](const std::string& extensions) {
        ModelFixture fixture;
        auto result = fixture.import(file("urn:t", variable("s=N", extensions)));
        return std::pair{fixture.label("N"), std::move(result.reports)};
    };
    const auto in_extension = import("<Extensions><Extension xmlns=\"" + uri +
                                     "\"><DataMapping Data=\"x\"/></Extension></Extensions>");
    CHECK(in_extension.first == "x");
    const auto further_out = import("<Extensions xmlns:m=\"" + uri +
                                    "\"><Extension><m:DataMapping Data=\"x\"/></Extension>"
                                    "</Extensions>");
    CHECK(further_out.first.empty());
    CHECK(has(further_out.second, ModelCode::NamespaceMisplaced));
    const auto other = import("<Extensions><Extension><DataMapping xmlns=\"urn:other\" Data=\"x\" "
                              "Foo=\"1\"/></Extension></Extensions>");
    CHECK(other.first.empty());
    CHECK(other.second.is_empty());
    const auto bare =
        import("<Extensions><Extension><DataMapping Data=\"x\"/></Extension></Extensions>");
    CHECK(bare.first.empty());
    CHECK(has(bare.second, ModelCode::NamespaceMisplaced));
    const auto outside =
        import("<Extensions><DataMapping xmlns=\"" + uri + "\" Data=\"x\"/></Extensions>");
    CHECK(outside.first.empty());
    CHECK(has(outside.second, ModelCode::FormatInvalid));
}

TEST_CASE("A-8 Reports: name the file, the node and the part", "[A-8][4.2]")
{
    const ReadOne read{"<DataMapping IsArray=\"true\"><Element Num=\"1\"><Element Data=\"x\"/>"
                       "</Element></DataMapping>"};
    REQUIRE(read.result.reports.list().size() == 1);
    const ModelReport& report = read.result.reports.list().front();
    CHECK(report.where == "t.xml: ns=1;s=N: [1]");
    CHECK(report.node == read.id("N"));
    CHECK(text(report) == "error M203 t.xml: ns=1;s=N: [1]: A mapping lacks an attribute: Num of "
                          "<Element>. Write the attribute.");
}

TEST_CASE("A-8 Limits: levels and parts are bounded", "[A-8]")
{
    std::string nested;
    std::string ends;
    for (int i = 0; i < 200; ++i) {
        nested += "<Field Name=\"F\" IsStructure=\"true\">";
        ends += "</Field>";
    }
    const ReadOne deep{"<DataMapping IsStructure=\"true\">" + nested + ends + "</DataMapping>"};
    CHECK(has(deep.result.reports, ModelCode::TooManyParts));
    CHECK(deep.data() == nullptr);
    ModelLimits few;
    few.max_parts = 2;
    const std::string element = "<Element Num=\"0\" Data=\"a\"/>";
    const ReadOne many{
        "<DataMapping IsArray=\"true\">" + element + element + element + "</DataMapping>", few};
    CHECK(has(many.result.reports, ModelCode::TooManyParts));
}

TEST_CASE("Additions: quality and scaling, Done and outputs are exported and imported")
{
    ModelFixture project;
    project.import(file("urn:t", cell() + variable("s=V") + method("s=M")));
    DataMapping& variable = project.models.mapping().variables[project.id("V")];
    variable.value.label = "Raw";
    variable.quality = "Quality";
    variable.scaling = {0, 1'000, 0, 50};
    MethodMapping& called = project.models.mapping().methods[project.id("M")];
    called.handle = "Start";
    called.done = "Ready";
    called.outputs.push_back({.number = 0, .is_array = true});
    called.outputs.back().parts.push_back(
        {.kind = MappedPart::Kind::Element, .number = 2, .label = "Result"});
    const std::string text = project.exported();
    ModelFixture again;
    const ImportResult imported = again.import(text);
    CAPTURE(text, lines(imported.reports));
    CHECK(imported.reports.is_empty());
    CHECK(again.exported() == text);
    const DataMapping& read = again.models.mapping().variables.at(again.id("V"));
    CHECK(read.quality == "Quality");
    CHECK(read.scaling == variable.scaling);
    const MethodMapping& method_read = again.models.mapping().methods.at(again.id("M"));
    CHECK(method_read.done == "Ready");
    CHECK(method_read.outputs == called.outputs);
    // Without them nothing of it is left.
    again.models.mapping().variables.clear();
    again.models.mapping().methods.clear();
    CHECK(again.exported().find("Addition") == std::string::npos);
    // The sign tells who changed one of them.
    std::string changed = text;
    changed.replace(changed.find("0..1000"), 7, "0..2000");
    CHECK(has(again.import(changed).reports, ModelCode::ChangedElsewhere));
}

TEST_CASE("Additions: what does not keep to the format is left out and told")
{
    const auto reports = [](const std::string& addition, bool is_mapped = true) {
        ModelFixture project;
        const std::string mapping = is_mapped ? "<Extension><DataMapping xmlns=\"" +
                                                    std::string{mapping_namespace} +
                                                    "\" Data=\"a\"/></Extension>"
                                              : "";
        return lines(project
                         .import(file("urn:t", variable("s=V", "<Extensions><Extension><Addition "
                                                               "xmlns=\"urn:busbar:mapping\" " +
                                                                   addition + "/></Extension>" +
                                                                   mapping + "</Extensions>")))
                         .reports);
    };
    CHECK(reports("Quality=\"q\" Scaling=\"0..1=2..3\"").empty());
    CHECK(reports("Scaling=\"0\"").find("M204") != std::string::npos);
    CHECK(reports("Quality=\"\"").find("M204") != std::string::npos);
    CHECK(reports("Done=\"x\"").find("M202") != std::string::npos);
    CHECK(reports("Quality=\"q\"", false).find("M207") != std::string::npos);
}

} // namespace mapping_extensions_test
