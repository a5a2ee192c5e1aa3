#include <algorithm>
#include <vector>

#include "nodeset_fixture.hpp"

// Files with the defects that files of vendors have: refused, or repaired by rules.

namespace busbar::model::nodeset_lenient_test {

namespace {

constexpr const char* below_objects =
    "<Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>";
constexpr const char* base_object = "<Reference ReferenceType=\"i=40\">i=58</Reference>";

std::string node(const std::string& element, const std::string& id, const std::string& references,
                 const std::string& attributes = {}, const std::string& content = {})
{
    return "<" + element + " NodeId=\"ns=1;" + id + "\" BrowseName=\"1:" + id + "\" " + attributes +
           "><References>" + references + "</References>" + content + "</" + element + ">\n";
}

/// A Variable with a value of one DataType.
std::string value_of(const std::string& attributes, const std::string& value)
{
    return variable_text("s=V", attributes, value);
}

std::string list(const std::string& type, std::initializer_list<const char*> values)
{
    std::string text = "<ListOf" + type + ">";
    for (const char* each : values) {
        text += "<" + type + ">" + each + "</" + type + ">";
    }
    return text + "</ListOf" + type + ">";
}

struct Lenient : NodeSetFixture {
    /// Loads a file that a strict load refuses with `refusal`; returns the repairs.
    std::vector<std::string> repairs(const std::string& content, const std::string& refusal)
    {
        const std::string refused = error_of(content);
        CHECK(refused.find(refusal) != std::string::npos);
        INFO(refused);
        return repairs({{"t.xml", nodeset_text(content), true}});
    }
    std::vector<std::string> repairs(const std::vector<NodeSetSource>& sources)
    {
        summary = load(sources);
        std::vector<std::string> texts;
        for (const NodeSetRepair& each : summary.repairs) {
            texts.push_back(text(each));
        }
        return texts;
    }

    NodeSetSummary summary;
};

using Texts = std::vector<std::string>;

} // namespace

TEST_CASE_METHOD(Lenient, "References that lead nowhere are left out")
{
    const Texts done = repairs(node("UAObject", "s=A",
                                    below_objects + std::string{base_object} +
                                        "\n<Reference ReferenceType=\"i=35\">ns=1;i=9</Reference>"
                                        "<Reference ReferenceType=\"i=39\">ns=1;i=8</Reference>"
                                        "<Reference ReferenceType=\"ns=1;i=7\">i=85</Reference>"
                                        "<Reference ReferenceType=\"HasSubtype\">i=58</Reference>"),
                               "t.xml:4: ns=1;s=A: found ");
    CHECK(done ==
          Texts{"t.xml:4: ns=1;s=A: left out a reference to nsu=urn:t;i=9, which is nowhere (rule "
                "dangling-reference)",
                "t.xml:4: ns=1;s=A: left out a reference to nsu=urn:t;i=8, which is nowhere (rule "
                "dangling-reference)",
                "t.xml:4: ns=1;s=A: left out a reference to i=85, whose ReferenceType "
                "nsu=urn:t;i=7 is nowhere (rule dangling-reference)",
                "t.xml:4: ns=1;s=A: left out a reference to i=58, a HasSubtype reference between "
                "Object and ObjectType (rule dangling-reference)"});
    CHECK(counted_repairs(summary) ==
          Texts{"4 times dangling-reference: references that lead nowhere were left out"});
    CHECK(find("s=A") != no_node);
    check_write_back(space, AddressSpace{}, {1}, summary);
}

TEST_CASE_METHOD(Lenient, "Instances without type definition have a base type")
{
    const Texts done = repairs(
        node("UAObject", "s=A", below_objects) +
            node("UAVariable", "s=V",
                 "<Reference ReferenceType=\"i=47\" IsForward=\"false\">ns=1;s=A</Reference>"
                 "<Reference ReferenceType=\"i=40\">i=58</Reference>") +
            node("UAVariable", "s=P",
                 "<Reference ReferenceType=\"i=46\" IsForward=\"false\">ns=1;s=A</Reference>"
                 "<Reference ReferenceType=\"i=40\">ns=1;i=9</Reference>"),
        "found ");
    CHECK(done ==
          Texts{"t.xml:4: ns=1;s=V: left out a reference to i=58, a HasTypeDefinition reference "
                "from Variable to ObjectType (rule dangling-reference)",
                "t.xml:5: ns=1;s=P: left out a reference to nsu=urn:t;i=9, which is nowhere (rule "
                "dangling-reference)",
                "t.xml:3: ns=1;s=A: took BaseObjectType for the type definition, which is missing "
                "(rule type-definition)",
                "t.xml:4: ns=1;s=V: took BaseDataVariableType for the type definition, which is "
                "missing (rule type-definition)",
                "t.xml:5: ns=1;s=P: took PropertyType for the type definition, which is missing "
                "(rule type-definition)"});
    CHECK(space.type_definition(find("s=A")) == space.find(id::BaseObjectType));
    CHECK(space.type_definition(find("s=V")) == space.find(id::BaseDataVariableType));
    CHECK(space.type_definition(find("s=P")) == space.find(id::PropertyType));
    check_write_back(space, AddressSpace{}, {1}, summary);
}

TEST_CASE_METHOD(Lenient, "Types without supertype are below a base type")
{
    const auto definition = [](const std::string& attributes, const std::string& field) {
        return "<Definition Name=\"T\" " + attributes + ">" + field + "</Definition>";
    };
    const Texts done = repairs(
        node("UAObjectType", "i=1", "") +
            node("UAObjectType", "i=2", "", "ParentNodeId=\"ns=1;i=1\"") +
            node("UAVariableType", "i=3", "", "ParentNodeId=\"ns=1;i=1\"") +
            node("UAReferenceType", "i=4", "") +
            node("UADataType", "i=5", "", "", definition("", field_text("A", "i=6"))) +
            node("UADataType", "i=6", "", "", definition("", "<Field Name=\"A\" Value=\"0\"/>")) +
            node("UADataType", "i=7", "", "",
                 definition("IsOptionSet=\"true\"", "<Field Name=\"A\" Value=\"0\"/>")) +
            node("UADataType", "i=8", "", "",
                 definition("IsUnion=\"true\"", field_text("A", "i=6"))) +
            node("UADataType", "i=9", ""),
        "t.xml:3: ns=1;i=1: found an ObjectType without supertype");
    CHECK(done.size() == 9);
    CHECK(done[1] == "t.xml:4: ns=1;i=2: took nsu=urn:t;i=1 for the supertype, which is missing "
                     "(rule supertype)");
    const auto above = [&](const char* id) { return space.supertype(find(id)); };
    CHECK(above("i=1") == space.find(id::BaseObjectType));
    CHECK(above("i=2") == find("i=1"));
    CHECK(above("i=3") == space.find(id::BaseVariableType));
    CHECK(above("i=4") == space.find(id::References));
    CHECK(above("i=5") == space.find(id::Structure));
    CHECK(above("i=6") == space.find(id::Enumeration));
    CHECK(above("i=7") == space.find(id::UInt32));
    CHECK(above("i=8") == space.find(id::Union));
    CHECK(above("i=9") == space.find(id::BaseDataType));
    check_write_back(space, AddressSpace{}, {1}, summary);
}

TEST_CASE_METHOD(Lenient, "A supertype that only its own side names is one")
{
    // From the type above in the same file, and from a node of namespace 0 that is there already.
    load(type_text("UAObjectType", "i=1", "i=58", "") +
         "<UAObjectType NodeId=\"i=58\" BrowseName=\"BaseObjectType\"><References>"
         "<Reference ReferenceType=\"HasSubtype\">ns=1;i=2</Reference></References>"
         "</UAObjectType>" +
         node("UAObjectType", "i=2",
              "<Reference ReferenceType=\"HasSubtype\">ns=1;i=3</Reference>") +
         node("UAObjectType", "i=3", ""));
    CHECK(space.supertype(find("i=2")) == space.find(id::BaseObjectType));
    CHECK(space.supertype(find("i=3")) == find("i=2"));
}

TEST_CASE_METHOD(Lenient, "The first of several types is kept")
{
    const Texts done =
        repairs(node("UAObjectType", "i=1",
                     "<Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=58</Reference>"
                     "<Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=61</Reference>"
                     "<Reference ReferenceType=\"HasSubtype\">i=61</Reference>") +
                    node("UAObject", "s=A",
                         std::string{below_objects} + base_object +
                             "<Reference ReferenceType=\"i=40\">i=61</Reference>"),
                "t.xml:3: ns=1;i=1: found ");
    CHECK(done == Texts{"t.xml:3: ns=1;i=1: left out the second HasSubtype reference to or from "
                        "i=61 (rule second-type)",
                        "t.xml:3: ns=1;i=1: left out the second HasSubtype reference to or from "
                        "i=61 (rule second-type)",
                        "t.xml:4: ns=1;s=A: left out the second HasTypeDefinition reference to or "
                        "from i=61 (rule second-type)"});
    CHECK(space.supertype(find("i=1")) == space.find(id::BaseObjectType));
    CHECK(space.type_definition(find("s=A")) == space.find(id::BaseObjectType));
}

TEST_CASE_METHOD(Lenient, "Names without alias are those of OPC UA")
{
    const std::string text =
        node("UAVariable", "s=V",
             "<Reference ReferenceType=\"Organizes\" IsForward=\"false\">i=85</Reference>"
             "<Reference ReferenceType=\"HasTypeDefinition\">BaseDataVariableType</Reference>",
             "DataType=\"Int32\"");
    const Texts done = repairs(
        text, "t.xml:3: ns=1;s=V: found \"Int32\", expected a NodeId or one of the <Aliases>");
    CHECK(done.size() == 4);
    CHECK(done[0] ==
          "t.xml:3: ns=1;s=V: took \"Int32\", which has no <Alias>, for i=6 (rule alias)");
    CHECK(space.variable(find("s=V")).data_type == space.find(id::Int32));
    CHECK(space.type_definition(find("s=V")) == space.find(id::BaseDataVariableType));
    // Others are refused by both.
    const std::vector<NodeSetSource> unknown{
        {"t.xml", nodeset_text(node("UAVariable", "s=V", "", "DataType=\"INT\"")), true}};
    CHECK(error_of(unknown).starts_with("t.xml:3: ns=1;s=V: found \"INT\""));
}

TEST_CASE_METHOD(Lenient, "Older models than required are taken, missing ones are not")
{
    const auto file = [](const std::string& uri, const std::string& attributes) {
        return std::vector<NodeSetSource>{
            {"t.xml",
             "<UANodeSet><Models><Model ModelUri=\"urn:t\">\n<RequiredModel ModelUri=\"" + uri +
                 "\" " + attributes + "/></Model></Models></UANodeSet>",
             true}};
    };
    const Texts done =
        repairs(file("http://opcfoundation.org/UA/", "PublicationDate=\"2099-01-01T00:00:00Z\""));
    REQUIRE(done.size() == 1);
    CHECK(done[0].starts_with("t.xml:2: the model \"urn:t\" requires "
                              "\"http://opcfoundation.org/UA/\" of 2099-01-01T00:00:00Z, found "));
    CHECK(done[0].ends_with(", and went on (rule older-model)"));
    CHECK(error_of(file("urn:nowhere", "")).find("found it in no file") != std::string::npos);
}

TEST_CASE_METHOD(Lenient, "Variables of DataTypes that are nowhere may have any value")
{
    const Texts done = repairs(value_of("DataType=\"ns=1;i=9\"", "<Int32>7</Int32>"),
                               "found the DataType nsu=urn:t;i=9");
    CHECK(done == Texts{"t.xml:3: ns=1;s=V: took BaseDataType for the DataType nsu=urn:t;i=9, "
                        "which is nowhere (rule data-type)"});
    CHECK(value("s=V") == Variant{7});
}

TEST_CASE_METHOD(Lenient, "Values are converted if nothing is lost")
{
    struct Case {
        const char* attributes;
        std::string value;
        Variant expected;
    };
    const auto strings = [](std::initializer_list<const char*> texts) {
        Array<LocalizedText> all;
        for (const char* each : texts) {
            all.push_back(LocalizedText{String{each}});
        }
        return Variant{std::move(all)};
    };
    const Case each = GENERATE_COPY(
        Case{"DataType=\"i=11\"", "<Int32>7</Int32>", Variant{7.0}},
        Case{"DataType=\"i=11\"", "<Int64>9007199254740992</Int64>", Variant{9007199254740992.0}},
        Case{"DataType=\"i=3\"", "<Int32>255</Int32>", Variant{std::uint8_t{255}}},
        Case{"DataType=\"i=6\"", "<Double>-2147483648</Double>", Variant{INT32_MIN}},
        Case{"DataType=\"i=10\"", "<Double>0.1</Double>", Variant{0.1F}},
        Case{"DataType=\"i=12\"", "<LocalizedText><Text>on</Text></LocalizedText>", Variant{"on"}},
        Case{"DataType=\"i=21\" ValueRank=\"1\"", list("String", {"a", "b"}), strings({"a", "b"})},
        Case{"DataType=\"i=6\" ValueRank=\"1\" ArrayDimensions=\"3\"", "<Int32>7</Int32>",
             Variant{Array<std::int32_t>{7}}},
        Case{"DataType=\"i=6\"", list("Int32", {"7"}), Variant{7}},
        Case{"DataType=\"i=6\" ValueRank=\"2\" ArrayDimensions=\"2,1\"", list("Int16", {"7", "8"}),
             Variant::matrix(Array<std::int32_t>{7, 8}, {2, 1})});
    const Texts done = repairs(value_of(each.attributes, each.value), "found a value <");
    REQUIRE(done.size() == 1);
    CHECK(done[0].find(": converted a value <") != std::string::npos);
    CHECK(done[0].ends_with("(rule value-converted)"));
    CHECK(value("s=V") == each.expected);
}

TEST_CASE_METHOD(Lenient, "A structure becomes one of a subtype without further fields")
{
    const auto options = [](const char* value) {
        return "<ExtensionObject><TypeId><Identifier>i=12757</Identifier></TypeId><Body><OptionSet "
               "xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\"><Value>" +
               std::string{value} +
               "</Value><ValidBits>gAM=</ValidBits></OptionSet></Body></ExtensionObject>";
    };
    const std::string type =
        type_text("UADataType", "i=25", "i=12755",
                  "<Definition Name=\"1:Bits\"><Field Name=\"Const\" Value=\"0\"/></Definition>") +
        encoding_text("i=33", "i=25");
    const auto bytes = [](std::initializer_list<unsigned> all) {
        std::vector<std::byte> result;
        for (const unsigned each : all) {
            result.push_back(std::byte(each));
        }
        return ByteString{std::span{std::as_const(result)}};
    };
    const auto expected = [&](unsigned low) {
        return ExtensionObject::from_binary(NodeId{1, 33},
                                            bytes({2, 0, 0, 0, low, 0, 2, 0, 0, 0, 0x80, 3}));
    };
    SECTION("one")
    {
        const Texts done = repairs(type + value_of("DataType=\"ns=1;i=25\"", options("AQA=")),
                                   "found a value <ExtensionObject>");
        REQUIRE(done.size() == 1);
        CHECK(done[0].ends_with("(rule value-converted)"));
        CHECK(value("s=V") == Variant{expected(1)});
    }
    SECTION("a list")
    {
        const Texts done =
            repairs(type + value_of("DataType=\"ns=1;i=25\" ValueRank=\"1\"",
                                    "<ListOfExtensionObject>" + options("AQA=") + options("AgA=") +
                                        "</ListOfExtensionObject>"),
                    "found a value <ListOfExtensionObject>");
        REQUIRE(done.size() == 1);
        CHECK(done[0].ends_with("(rule value-converted)"));
        CHECK(value("s=V") == Variant{Array<ExtensionObject>{expected(1), expected(2)}});
    }
    SECTION("of another type")
    {
        const Texts done = repairs(type + value_of("DataType=\"i=884\"", options("AQA=")),
                                   "found a value <ExtensionObject>");
        REQUIRE(done.size() == 1);
        CHECK(done[0].ends_with("(rule value-removed)"));
    }
}

TEST_CASE_METHOD(Lenient, "Names of types in values are their NodeIds")
{
    const auto argument = [](const std::string& type) {
        return "<ExtensionObject><TypeId><Identifier>i=297</Identifier></TypeId><Body><Argument>"
               "<Name>A</Name><DataType><Identifier>" +
               type + "</Identifier></DataType></Argument></Body></ExtensionObject>";
    };
    const auto variable = [&](const std::string& type) {
        return value_of("DataType=\"i=296\"", argument(type));
    };
    const Texts done =
        repairs(variable("String"), "found <Identifier> \"String\", expected a NodeId");
    CHECK(done == Texts{"t.xml:3: ns=1;s=V: took \"String\" and the like in a value for DataTypes "
                        "(rule alias)"});
    Lenient strict;
    strict.load(variable("i=12"));
    CHECK(value("s=V") == strict.value("s=V"));
    Lenient other;
    CHECK(other.repairs(variable("Nothing"), "expected a NodeId")
              .at(0)
              .ends_with("(rule value-removed)"));
    CHECK(other.value("s=V").is_null());
}

TEST_CASE_METHOD(Lenient, "ArrayDimensions that a value exceeds are 0")
{
    struct Case {
        const char* attributes;
        std::string value;
        Variant expected;
    };
    const std::string matrix = "<Matrix><Dimensions><UInt32>2</UInt32><UInt32>2</UInt32>"
                               "</Dimensions><Elements><Int32>1</Int32><Int32>2</Int32><Int32>3"
                               "</Int32><Int32>4</Int32></Elements></Matrix>";
    const Case each =
        GENERATE_COPY(Case{"DataType=\"i=6\" ValueRank=\"1\" ArrayDimensions=\"1\"",
                           list("Int32", {"7", "8"}), Variant{Array<std::int32_t>{7, 8}}},
                      Case{"DataType=\"i=6\" ValueRank=\"2\" ArrayDimensions=\"2,1\"", matrix,
                           Variant::matrix(Array<std::int32_t>{1, 2, 3, 4}, {2, 2})},
                      // The value decides how many there are.
                      Case{"DataType=\"i=6\" ValueRank=\"1\" ArrayDimensions=\"2,2\"",
                           list("Int32", {"7", "8"}), Variant{Array<std::int32_t>{7, 8}}},
                      Case{"DataType=\"i=6\" ValueRank=\"2\" ArrayDimensions=\"9\"", matrix,
                           Variant::matrix(Array<std::int32_t>{1, 2, 3, 4}, {2, 2})});
    const Texts done = repairs(value_of(each.attributes, each.value), "found a value <");
    REQUIRE(done.size() == 1);
    CHECK(done[0].find(": set ArrayDimensions to 0, which a value <") != std::string::npos);
    CHECK(done[0].ends_with("(rule array-dimensions)"));
    CHECK(value("s=V") == each.expected);
    const std::size_t rank = each.expected.is_matrix() ? 2 : 1;
    CHECK(std::ranges::equal(space.variable(find("s=V")).array_dimensions,
                             std::vector<std::uint32_t>(rank)));
    check_write_back(space, AddressSpace{}, {1}, summary);
}

TEST_CASE_METHOD(Lenient, "Values that cannot be converted are null")
{
    const auto [attributes, value] = GENERATE(table<std::string, std::string>({
        {"DataType=\"i=6\"", "<String>seven</String>"},
        {"DataType=\"i=6\"", "<String>7</String>"},
        {"DataType=\"i=3\"", "<Int32>256</Int32>"},
        {"DataType=\"i=3\"", "<Int32>-1</Int32>"},
        {"DataType=\"i=6\"", "<Double>0.5</Double>"},
        {"DataType=\"i=6\"", "<Double>2147483648</Double>"},
        {"DataType=\"i=8\"", "<Double>9223372036854775808</Double>"},
        {"DataType=\"i=6\"", "<Double>NaN</Double>"},
        {"DataType=\"i=6\"", "<Double>INF</Double>"},
        {"DataType=\"i=11\"", "<Int64>9007199254740993</Int64>"},
        {"DataType=\"i=11\"", "<Int64>9223372036854775807</Int64>"},
        {"DataType=\"i=10\"", "<Double>1e300</Double>"},
        {"DataType=\"i=1\"", "<Int32>1</Int32>"},
        {"DataType=\"i=6\"", list("Int32", {"7", "8"})},
        {"DataType=\"i=6\"", list("Int32", {})},
        {"DataType=\"i=6\" ValueRank=\"2\" ArrayDimensions=\"2,3\"", list("Int32", {"7", "8"})},
        {"DataType=\"i=6\" ValueRank=\"2\" ArrayDimensions=\"0,2\"", list("Int32", {"7", "8"})},
        {"DataType=\"i=6\" ValueRank=\"2\" ArrayDimensions=\"65536,65536\"",
         list("Int32", {"7", "8"})},
    }));
    const Texts done = repairs(value_of(attributes, value), "found a value <");
    REQUIRE(done.size() == 1);
    CHECK(done[0].find(": left out a value <") != std::string::npos);
    CHECK(done[0].ends_with("(rule value-removed)"));
    CHECK(this->value("s=V").is_null());
    CHECK(summary.repair_counts[static_cast<std::size_t>(NodeSetRule::ValueRemoved)] == 1);
}

TEST_CASE_METHOD(Lenient, "Values that cannot be read are null")
{
    const Texts done = repairs(value_of("DataType=\"i=6\"", "<Int32>x</Int32>"),
                               "found <Int32> \"x\", expected a number");
    CHECK(done == Texts{"t.xml:3: ns=1;s=V: left out a value: found <Int32> \"x\", expected a "
                        "number in the range of its type (rule value-removed)"});
    CHECK(value("s=V").is_null());
}

TEST_CASE_METHOD(Lenient, "A list of the right length is a matrix in strict files, too")
{
    const NodeSetSummary loaded =
        load(value_of("DataType=\"i=6\" ValueRank=\"2\" ArrayDimensions=\"2,3\"",
                      list("Int32", {"0", "1", "2", "3", "4", "5"})));
    CHECK(loaded.notes.empty());
    CHECK(value("s=V") == Variant::matrix(Array<std::int32_t>{0, 1, 2, 3, 4, 5}, {2, 3}));
    check_write_back(space, AddressSpace{}, {1}, loaded);
}

TEST_CASE_METHOD(Lenient, "Only files that are lenient are repaired, and no more repairs are told")
{
    const std::string defect = node("UAObject", "s=A", below_objects);
    CHECK(error_of({{"strict.xml", nodeset_text(defect)},
                    {"lenient.xml", nodeset_text(node("UAObject", "s=B", below_objects)), true}}) ==
          "strict.xml:3: ns=1;s=A: found an Object without HasTypeDefinition");
    NodeSetLimits limits;
    limits.max_errors = 1;
    summary = load({{"t.xml", nodeset_text(defect + node("UAObject", "s=B", below_objects)), true}},
                   limits);
    CHECK(summary.repairs.size() == 1);
    CHECK(counted_repairs(summary) ==
          Texts{"2 times type-definition: the missing type definitions are base types"});
}

} // namespace busbar::model::nodeset_lenient_test
