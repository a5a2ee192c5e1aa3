#include "mapping_fixture.hpp"

namespace mapping_sign_test {

using namespace busbar;
using namespace busbar::controller;

TEST_CASE("A-8 Sign: tells mappings apart and not nodes", "[A-8]")
{
    DataMapping mapping;
    mapping.value.label = "a";
    const std::string sign = sign_of(mapping);
    CHECK(is_own_sign(sign));
    CHECK_FALSE(is_own_sign("xxxxxxx"));
    CHECK_FALSE(is_own_sign("busbar-" + std::string(32, 'X')));
    mapping.sign = sign;
    CHECK(sign_of(mapping) == sign);
    mapping.value.specification.rank = 1;
    CHECK(sign_of(mapping) != sign);
    MethodMapping method;
    method.handle = "a";
    CHECK(sign_of(method) != sign);
    const std::string handle_only = sign_of(method);
    method.arguments.push_back({.number = 0, .label = "b"});
    CHECK(sign_of(method) != handle_only);
}

TEST_CASE("A-8 Sign: a change with another tool is found at import", "[A-8]")
{
    ModelFixture project;
    project.import(file("urn:t", cell() + variable("s=A") + method("s=M")));
    project.map("A", "before");
    project.models.mapping().methods[project.id("M")].handle = "Start";
    const std::string exported = project.exported();
    CHECK(project.import(exported).reports.is_empty());

    const auto changed = [&](const std::string& what, const std::string& to) {
        std::string text = exported;
        text.replace(text.find('"' + what + '"'), what.size() + 2, '"' + to + '"');
        return project.import(text).reports;
    };
    const ModelReports data = changed("before", "after");
    CHECK(has(data, ModelCode::ChangedElsewhere));
    CHECK(project.label("A") == "after");
    CHECK(has(changed("Start", "Stop"), ModelCode::ChangedElsewhere));
}

TEST_CASE("A-8 Sign: that of another tool, or none, says nothing", "[A-8]")
{
    ModelFixture project;
    const auto result = project.import(
        file("urn:t", variable("s=A", extension("<DataMapping Data=\"a\" Sign=\"xxxxxxx\"/>")) +
                          variable("s=B", extension("<DataMapping Data=\"b\"/>"))));
    CHECK(result.reports.is_empty());
    CHECK(project.models.mapping().variables.at(project.id("A")).sign == "xxxxxxx");
}

TEST_CASE("A-8 Writing: a round trip keeps the mapping and what others extend", "[A-8][9.4]")
{
    const std::string foreign = "<Extension><v:Colour xmlns:v=\"urn:vendor\" v:rgb=\"ff\">&lt;"
                                "</v:Colour></Extension>";
    const std::string own = extension(
        "<DataMapping IsArray=\"true\" IsStructure=\"true\" Rank=\"1\" Dim1=\"2\">"
        "<Element Num=\"1\"><Field Name=\"F&amp;\" Data=\"b&lt;&quot;\"/></Element>"
        "<Element Num=\"0\"><Field Name=\"G\" IsArray=\"true\"><Element Num=\"0\" Data=\"c\"/>"
        "</Field></Element></DataMapping>");
    const std::string both = own.substr(0, own.find("</Extensions>")) + foreign + "</Extensions>";
    ModelFixture first;
    first.import(file("urn:t", variable("s=A", both) +
                                   variable("s=B", "<Extensions>" + foreign + "</Extensions>")));
    Mapping expected = first.models.mapping();
    drop_unmapped(expected);
    const std::string exported = first.exported();
    CHECK(exported.find("IsArray=\"true\"") != std::string::npos);

    ModelFixture second;
    CHECK(second.import(exported).reports.is_empty());
    Mapping again = second.models.mapping();
    for (auto& [id, each] : again.variables) {
        CHECK(is_own_sign(each.sign));
        each.sign.clear();
    }
    CHECK(again == expected);
    // Without mapping only the foreign extensions are left, of both nodes the same.
    second.models.mapping() = {};
    ModelFixture third;
    third.import(second.exported());
    CHECK(third.models.mapping() == Mapping{});
    const auto& extras = third.models.extras().nodes;
    CHECK(extras.at(third.id("A")).elements == extras.at(third.id("B")).elements);
    CHECK(extras.at(third.id("A")).elements.find("v:rgb=\"ff\"") != std::string::npos);
    CHECK(second.exported() == third.exported());
}

TEST_CASE("9.5 Mapping array specification: without mapping it is not saved", "[9.5]")
{
    ModelFixture project;
    project.import(file("urn:t", variable("s=A", extension("<DataMapping IsArray=\"true\" "
                                                           "Rank=\"1\" Dim1=\"2\"/>"))));
    CHECK(project.models.mapping().variables.size() == 1);
    CHECK(project.exported().find("DataMapping") == std::string::npos);
}

} // namespace mapping_sign_test
