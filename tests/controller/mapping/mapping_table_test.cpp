#include <busbar/controller/mappable_parts.hpp>
#include <busbar/controller/mapping_table.hpp>

#include "mapping_fixture.hpp"

namespace mapping_table_test {

using namespace busbar;
using namespace busbar::controller;

namespace {

const std::string head = "NodeId,Path,Part,Label,Rank,Dim1,Dim2,Dim3\r\n";

struct TableFixture : ModelFixture {
    TableFixture()
    {
        import(file("urn:t", cell() + variable("s=A") + variable("s=B") + method("s=M")));
    }
    [[nodiscard]] ReadMappingTable read(const std::string& text,
                                        const MappingTableLimits& limits = {}) const
    {
        return read_mapping_table(text, models.space(), limits);
    }
    [[nodiscard]] std::string label_in(const std::string& text, const std::string& name = "A") const
    {
        const ReadMappingTable read_back = read(text);
        const auto found = read_back.mapping.variables.find(id(name));
        return found == read_back.mapping.variables.end() ? "" : found->second.value.label;
    }
    [[nodiscard]] std::string error_in(const std::string& text,
                                       const MappingTableLimits& limits = {}) const
    {
        const ReadMappingTable read_back = read(text, limits);
        if (read_back.reports.list().empty()) {
            return {};
        }
        const ModelReport& report = read_back.reports.list().front();
        return std::to_string(static_cast<int>(report.code)) + ' ' + report.where;
    }
};

} // namespace

TEST_CASE("9.5 Table: what is written is read as the same", "[9.5]")
{
    TableFixture project;
    Mapping& mapping = project.models.mapping();
    MappedPart& value = mapping.variables[project.id("A")].value;
    value.is_array = true;
    value.is_structure = true;
    value.specification = {1, {3, 0, 0}};
    MappedPart inner{.kind = MappedPart::Kind::Field, .name = "a.[b]\\", .label = "x,\"y\"\n"};
    value.parts.push_back({.kind = MappedPart::Kind::Element, .number = 2, .parts = {inner}});
    mapping.variables[project.id("B")].value.label = " Line.Speed";
    MethodMapping& method_mapping = mapping.methods[project.id("M")];
    method_mapping.handle = "Start";
    method_mapping.arguments.push_back({.number = 1, .is_array = true});
    method_mapping.arguments.back().parts.push_back(
        {.kind = MappedPart::Kind::Element, .number = 4, .label = "Second"});
    const std::string text = write_mapping_table(project.models.space(), mapping);
    CHECK(text == head + "nsu=urn:t;s=A,/Objects/1:A,,,1,3,,\r\n"
                         "nsu=urn:t;s=A,/Objects/1:A,[2].a\\.\\[b\\]\\\\,\"x,\"\"y\"\"\n\",,,,\r\n"
                         "nsu=urn:t;s=B,/Objects/1:B,,\" Line.Speed\",,,,\r\n"
                         "nsu=urn:t;s=M,/Objects/1:Cell/1:M,Handle,Start,,,,\r\n"
                         "nsu=urn:t;s=M,/Objects/1:Cell/1:M,Input[1][4],Second,,,,\r\n");
    const ReadMappingTable read_back = project.read(text);
    CAPTURE(lines(read_back.reports));
    CHECK(read_back.reports.is_empty());
    CHECK(read_back.mapping == mapping);
}

TEST_CASE("9.5 Table: a label is of no array when the elements beside it are not mapped", "[9.5]")
{
    TableFixture project;
    Mapping mapping = project
                          .read(head + "nsu=urn:t;s=A,,,Line.Speed,,,,\r\n"
                                       "nsu=urn:t;s=A,,[0],,2,3,4,\r\n")
                          .mapping;
    drop_unmapped(mapping);
    const MappedPart& value = mapping.variables.at(project.id("A")).value;
    CHECK(value == MappedPart{.label = "Line.Speed"});
    const std::string text = write_mapping_table(project.models.space(), mapping);
    CHECK(project.read(text).mapping.variables.at(project.id("A")).value == value);
}

TEST_CASE("9.5 Table: elements are no structures when their fields are not mapped", "[9.5]")
{
    TableFixture project;
    Mapping mapping = project
                          .read(head + "nsu=urn:t;s=A,,[0].f,,1,3,,\r\n"
                                       "nsu=urn:t;s=A,,[1],Line.Speed,,,,\r\n")
                          .mapping;
    drop_unmapped(mapping);
    const MappedPart& value = mapping.variables.at(project.id("A")).value;
    CHECK(value.is_array);
    CHECK_FALSE(value.is_structure);
    const std::string text = write_mapping_table(project.models.space(), mapping);
    CHECK(project.read(text).mapping.variables.at(project.id("A")).value == value);
}

TEST_CASE("9.5 Table: nodes by NodeId or by path, columns in any order", "[9.5]")
{
    const TableFixture project;
    CHECK(project.label_in(head + "nsu=urn:t;s=A,,,a\n") == "a");
    CHECK(project.label_in(head + "ns=1;s=A,,,a\n") == "a");
    CHECK(project.label_in(head + ",/Objects/1:A,,a\n") == "a");
    CHECK(project.label_in("Label;Comment;PART;Path\n\"a;b\";x;;/Objects/1:A\n") == "a;b");
    CHECK(project.label_in("\xEF\xBB\xBFPath\tPart\tLabel\r/Objects/1:A\t\ta\r") == "a");
    CHECK(project.label_in(head + "\n,,,\nns=1;s=A,,,a") == "a");
}

TEST_CASE("9.5 Table: errors have the line, and the other lines count", "[9.5]")
{
    const TableFixture project;
    const std::string good = "ns=1;s=B,,,b\n";
    const auto error = [&](const std::string& line) {
        const std::string text = head + "ns=1;s=M,,Handle,\"h\n\"\n" + line + '\n' + good;
        CHECK(project.label_in(text, "B") == "b");
        return project.error_in(text);
    };
    // The second line of the table has a line break in it.
    CHECK(error("ns=1;s=X,,,x") == "504 line 4");
    CHECK(error("nsu=urn:x;s=A,,,x") == "504 line 4");
    CHECK(error("svr=1;ns=1;s=A,,,x") == "504 line 4");
    CHECK(error(",/Objects/1:X,,x") == "504 line 4");
    CHECK(error(",no path,,x") == "504 line 4");
    CHECK(error("ns=1;s=Cell,,,x") == "504 line 4");
    CHECK(error("ns=1;s=A,,[x],x") == "505 line 4");
    CHECK(error("ns=1;s=A,,[1,x") == "505 line 4");
    CHECK(error("ns=1;s=A,,Name,x") == "505 line 4");
    CHECK(error("ns=1;s=A,,.a\\,x") == "505 line 4");
    CHECK(error("ns=1;s=A,,[0][0][0][0],x") == "505 line 4");
    CHECK(error("ns=1;s=A,,[1000000],x") == "505 line 4");
    CHECK(error("ns=1;s=M,,Outcome[0],x") == "505 line 4");
    CHECK(error("ns=1;s=M,,Input.A,x") == "505 line 4");
    CHECK(error("ns=1;s=A,,,,4") == "506 line 4");
    CHECK(error("ns=1;s=A,,,,1,0") == "506 line 4");
    CHECK(error("ns=1;s=A,,,,1,x") == "506 line 4");
    CHECK(error("ns=1;s=M,,Handle,x") == "507 line 4");
    CHECK(error("ns=1;s=A,,[0],x\nns=1;s=A,,[0],y") == "507 line 5");
    CHECK(error("ns=1;s=A,,[0],x\nns=1;s=A,,.F,y") == "505 line 5");
}

TEST_CASE("9.5 Table: what is no table, or too large", "[9.5]")
{
    const TableFixture project;
    CHECK(project.error_in("") == "501 line 1");
    CHECK(project.error_in("NodeId,Label\n") == "503 line 1");
    CHECK(project.error_in("Part,Label\n") == "503 line 1");
    CHECK(project.error_in("NodeId,Part,Label,label\n") == "503 line 1");
    CHECK(project.error_in(head + "\"ns=1;s=A,,,a\n") == "501 line 2");
    CHECK(project.error_in(head + "\"ns=1;s=A\"x,,,a\n") == "501 line 2");
    CHECK(project.error_in(head + "ns=1;s=\"A\",,,a\n") == "501 line 2");
    MappingTableLimits limits;
    limits.max_size = 10;
    CHECK(project.error_in(head, limits) == "502 ");
    limits = {};
    limits.max_lines = 1;
    CHECK(project.error_in(head + "\n\n", limits) == "502 line 3");
    limits = {};
    limits.max_field = 8;
    CHECK(project.error_in(head + "\"123456789\"\n", limits) == "502 line 2");
    CHECK(project.error_in(head + "123456789\n", limits) == "502 line 2");
    CHECK(project.error_in(head + std::string(64, ',') + '\n') == "502 line 2");
    limits = {};
    limits.max_part_levels = 2;
    CHECK(project.error_in(head + "ns=1;s=A,,.a.b.c,x\n", limits) == "505 line 2");
}

TEST_CASE("9.4 Table: all that there is to map, mapped or not", "[9.4][9.5]")
{
    const std::string structure =
        "<UADataType NodeId=\"ns=1;s=S\" BrowseName=\"1:S\"><References>"
        "<Reference ReferenceType=\"i=45\" IsForward=\"false\">i=22</Reference></References>"
        "<Definition Name=\"1:S\"><Field Name=\"A\" DataType=\"i=6\"/>"
        "<Field Name=\"G\" DataType=\"i=14\"/></Definition></UADataType>\n";
    ModelFixture project;
    project.import(file("urn:t", cell() + structure + variable("s=One") + method("s=Start") +
                                     variable("s=Guid", {}, "DataType=\"i=14\"") +
                                     variable("s=Two", {},
                                              "DataType=\"ns=1;s=S\" ValueRank=\"1\" "
                                              "ArrayDimensions=\"2\"")));
    project.map("One", "Line.One");
    const std::string text = write_mappable_table(project.models);
    const std::string with_type = head.substr(0, head.size() - 2) + ",Type\r\n";
    CHECK(text == with_type + "nsu=urn:t;s=One,/Objects/1:One,,Line.One,,,,,Int32\r\n"
                              "nsu=urn:t;s=Start,/Objects/1:Cell/1:Start,Handle,,,,,,UInt16\r\n"
                              "nsu=urn:t;s=Two,/Objects/1:Two,[0].A,,,,,,Int32\r\n"
                              "nsu=urn:t;s=Two,/Objects/1:Two,[1].A,,,,,,Int32\r\n");
    const ReadMappingTable read = read_mapping_table(text, project.models.space());
    CHECK(read.reports.is_empty());
    CHECK(read.mapping == project.models.mapping());
    CHECK(write_mappable_table(project.models, PartsWritten::Unmapped) ==
          with_type + "nsu=urn:t;s=Start,/Objects/1:Cell/1:Start,Handle,,,,,,UInt16\r\n"
                      "nsu=urn:t;s=Two,/Objects/1:Two,[0].A,,,,,,Int32\r\n"
                      "nsu=urn:t;s=Two,/Objects/1:Two,[1].A,,,,,,Int32\r\n");

    // A label that cannot be there is shown, too.
    project.map("Guid", "Line.Guid");
    MappableParts parts{project.models};
    const auto found = parts.of(project.models.space().find(project.id("Guid")));
    REQUIRE(found.size() == 1);
    CHECK(found[0].label == "Line.Guid");
    CHECK(found[0].type.empty());
    CHECK(parts.of(project.models.space().find(project.id("Cell"))).empty());

    // What assignability() is asked with, and why there is nothing to map.
    const model::SpaceReader& space = project.models.space();
    CHECK(parts.of(find_table_node("/Objects/1:One", space)).front().leaf.built_in ==
          BuiltInType::Int32);
    CHECK(parts.why_none(find_table_node("nsu=urn:t;s=Two", space)).empty());
    CHECK(parts.why_none(find_table_node("ns=1;s=Start", space)).empty());
    CHECK(parts.why_none(find_table_node("/Objects/1:Guid", space)) ==
          "The DataType, ValueRank or ArrayDimensions cannot have a label");
    CHECK(parts.why_none(find_table_node("/Objects", space)) ==
          "A node of namespace 0 cannot be mapped");
    CHECK(parts.why_none(space.find(project.id("Cell"))) ==
          "It is neither a Variable nor a Method");
    CHECK(find_table_node("/Objects/1:Three", space) == model::no_node);
    CHECK(find_table_node("nonsense", space) == model::no_node);
}

TEST_CASE("Table: quality, scaling, Done and outputs are written and read as the same")
{
    TableFixture project;
    Mapping& mapping = project.models.mapping();
    DataMapping& variable = mapping.variables[project.id("A")];
    variable.value.label = "Raw";
    variable.quality = "Raw_Q";
    variable.scaling = {0, 27'648, -10, 0.1};
    mapping.variables[project.id("B")].value.label = "Other";
    mapping.variables[project.id("B")].scaling = {4'000, 20'000};
    MethodMapping& called = mapping.methods[project.id("M")];
    called.handle = "Start";
    called.done = "Ready";
    called.outputs.push_back({.number = 1, .label = "Result"});
    const std::string text = write_mapping_table(project.models.space(), mapping);
    CHECK(text == head + "nsu=urn:t;s=A,/Objects/1:A,,Raw,,,,\r\n"
                         "nsu=urn:t;s=A,/Objects/1:A,Quality,Raw_Q,,,,\r\n"
                         "nsu=urn:t;s=A,/Objects/1:A,Scaling,0..27648=-10..0.1,,,,\r\n"
                         "nsu=urn:t;s=B,/Objects/1:B,,Other,,,,\r\n"
                         "nsu=urn:t;s=B,/Objects/1:B,Scaling,4000..20000,,,,\r\n"
                         "nsu=urn:t;s=M,/Objects/1:Cell/1:M,Handle,Start,,,,\r\n"
                         "nsu=urn:t;s=M,/Objects/1:Cell/1:M,Done,Ready,,,,\r\n"
                         "nsu=urn:t;s=M,/Objects/1:Cell/1:M,Output[1],Result,,,,\r\n");
    const ReadMappingTable read_back = project.read(text);
    CAPTURE(lines(read_back.reports));
    CHECK(read_back.reports.is_empty());
    CHECK(read_back.mapping == mapping);
    CHECK(count_labels(mapping) == 6);
}

TEST_CASE("Table: what is no scaling is told with line, found and expected")
{
    TableFixture project;
    const auto message = [&](const std::string& scaling) {
        return lines(
            project.read("NodeId,Part,Label\nns=1;s=A,,Raw\nns=1;s=A,Scaling," + scaling + "\n")
                .reports);
    };
    CHECK(message("0..100").empty());
    CHECK(message("-1e3..1.5=0..-2").empty());
    for (const char* const wrong :
         {"abc", "0", "0..", "0..0", "0..1=", "0..1=2", "0..1=2..2", "0..inf", "nan..1", " 0..1",
          "0..1=0..1=0..1", "-1e308..1e308", "0...5..1"}) {
        CAPTURE(wrong);
        const std::string text = message(wrong);
        CHECK(text.find("M508") != std::string::npos);
        CHECK(text.find("line 3") != std::string::npos);
        CHECK(text.find("found " + std::string{wrong}) != std::string::npos);
        CHECK(text.find("0..27648=0..100") != std::string::npos);
    }
    CHECK(project.error_in("NodeId,Part,Label\nns=1;s=A,Quality,a\nns=1;s=A,Quality,b\n") ==
          "507 line 3");
    CHECK(project.error_in("NodeId,Part,Label\nns=1;s=M,Output,a\n") == "505 line 2");
}

} // namespace mapping_table_test
