#include "nodeset_fixture.hpp"

#include <busbar/binary/codec.hpp>
#include <busbar/types/types.hpp>

namespace busbar::model::nodeset_write_test {

namespace {

constexpr const char* any = "DataType=\"i=24\" ValueRank=\"-2\"";

bool has(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

struct WriteFixture : NodeSetFixture {
    /// Whatever is loaded must re-read equal; gives the file.
    std::string rewritten(const std::string& content)
    {
        summary = load(content);
        check_write_back(space, AddressSpace{}, {1}, summary);
        return write_nodeset(space, std::vector<std::uint16_t>{1}, summary.extras).value();
    }
    /// The file with this value of the Variable V.
    std::string written(const Variant& value)
    {
        REQUIRE(space.set_value(find("s=V"), value));
        check_write_back(space, AddressSpace{}, {1}, summary);
        return write_nodeset(space, std::vector<std::uint16_t>{1}, summary.extras).value();
    }
    std::string written(std::uint32_t type, const std::vector<unsigned char>& body)
    {
        return written(Variant{ExtensionObject::from_binary(
            NodeId{1, type}, ByteString{std::as_bytes(std::span{body})})});
    }

    NodeSetSummary summary;
};

} // namespace

TEST_CASE_METHOD(WriteFixture, "Structures whose bytes do not fit their type are written as bytes")
{
    summary =
        load(variable_text("s=V", any, "") +
             structure_text("i=20", "i=12756", field_text("A", "i=3") + field_text("B", "i=12"),
                            "IsUnion=\"true\"") +
             structure_text("i=30", "i=22", field_text("Grid", "i=3", "ValueRank=\"2\"")) +
             structure_text("i=40", "i=22",
                            field_text("A", "i=3", "IsOptional=\"true\"") +
                                field_text("List", "i=3", "ValueRank=\"1\"")) +
             structure_text("i=50", "i=22", field_text("What", "ns=1;i=99")) +
             structure_text("i=60", "i=22", field_text("Again", "ns=1;i=60")) +
             structure_text("i=70", "i=22", field_text("No name", "i=3")) +
             structure_text("i=80", "i=22", field_text("When", "i=13")));
    const auto is_bytes = [&](std::uint32_t type, const std::vector<unsigned char>& body) {
        const std::string text = written(type, body);
        return has(text, "<Identifier>ns=1;i=" + std::to_string(type) + "</Identifier>") &&
               has(text, "<ByteString>") && !has(text, "<T" + std::to_string(type) + ">");
    };
    CHECK_FALSE(is_bytes(20, {1, 0, 0, 0, 5}));
    CHECK(is_bytes(20, {3, 0, 0, 0, 5}));
    CHECK(is_bytes(20, {1, 0, 0, 0}));
    CHECK(is_bytes(20, {1, 0, 0, 0, 5, 6}));
    CHECK_FALSE(is_bytes(20, {0, 0, 0, 0}));
    CHECK_FALSE(is_bytes(30, {2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 7}));
    CHECK_FALSE(is_bytes(30, {255, 255, 255, 255}));
    CHECK(is_bytes(30, {1, 0, 0, 0, 1, 0, 0, 0, 7}));
    CHECK(is_bytes(30, {2, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 7}));
    CHECK(is_bytes(30, {2, 0, 0, 0, 255, 255, 255, 127, 255, 255, 255, 127, 7}));
    CHECK_FALSE(is_bytes(40, {1, 0, 0, 0, 7, 0, 0, 0, 0}));
    CHECK_FALSE(is_bytes(40, {0, 0, 0, 0, 255, 255, 255, 255}));
    CHECK(is_bytes(40, {2, 0, 0, 0, 255, 255, 255, 255}));
    CHECK(is_bytes(40, {0, 0, 0, 0, 2, 0, 0, 0, 1}));
    CHECK(is_bytes(50, {1}));
    CHECK(is_bytes(60, {1}));
    CHECK(is_bytes(70, {1}));
    CHECK(is_bytes(80, {1, 2, 3}));
}

TEST_CASE_METHOD(WriteFixture, "Structures of C++ types are written by their XML encodings")
{
    summary = load(variable_text("s=V", any, "") +
                   structure_text("i=20", "i=22", field_text("A", "i=3")) +
                   "<UAObject NodeId=\"ns=1;i=21\" BrowseName=\"Default XML\"><References>"
                   "<Reference ReferenceType=\"i=38\" IsForward=\"false\">ns=1;i=20</Reference>"
                   "<Reference ReferenceType=\"i=40\">i=76</Reference></References></UAObject>");
    const auto read_back = [&](const std::string& text) {
        NodeSetFixture other;
        other.load({{"t.xml", text}});
        return other.value("s=V");
    };
    Argument argument;
    argument.name = "a";
    argument.data_type = NodeId{0, 6U};
    const Variant value{ExtensionObject::from(argument)};
    const std::string text = written(value);
    CHECK(has(text, "<Identifier>i=297</Identifier>"));
    CHECK(has(text, "<Name>a</Name>"));
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, argument);
    const auto bytes = sink.take(writer.written());
    CHECK(read_back(text) ==
          Variant{ExtensionObject::from_binary(NodeId{0, 298U}, ByteString{std::span{bytes}})});
    CHECK(has(written(20, {9}), "<Identifier>ns=1;i=21</Identifier>"));
    CHECK(has(written(20, {9}), "<A>9</A>"));
    CHECK(has(written(Variant{ExtensionObject::from_xml(NodeId{1, 5U}, XmlElement{"<x/>"})}),
              "<Body><x/></Body>"));
    const std::string bare = written(Variant{ExtensionObject::from_id(NodeId{1, 20U})});
    CHECK(has(bare, "<Identifier>ns=1;i=20</Identifier>"));
    CHECK_FALSE(has(bare, "<Body>"));
}

TEST_CASE_METHOD(WriteFixture, "Texts that XML has no room for are written so that they come back")
{
    summary = load(variable_text("s=V", any, ""));
    CHECK(has(written(Variant{"\"a\"\r\n<&>\x01"}), "&quot;a&quot;&#13;\n&lt;&amp;&gt;&#1;"));
    CHECK(has(written(Variant{""}), "<String><![CDATA[]]></String>"));
    CHECK(has(written(Variant{XmlElement{"<a b=\"1\"><c>&lt;</c></a>"}}),
              "<XmlElement><a b=\"1\"><c>&lt;</c></a></XmlElement>"));
    REQUIRE(space.set_value(find("s=V"), Variant{String{std::string_view{"a\0b", 3}}}));
    const std::vector<std::uint16_t> namespaces{1};
    CHECK(has(write_nodeset(space, namespaces).value(), "<String>a&#xFFFD;b</String>"));
    REQUIRE(space.set_value(find("s=V"), Variant{XmlElement{"<a"}}));
    CHECK(has(write_nodeset(space, namespaces).value(), "<XmlElement>&lt;a</XmlElement>"));
    // Names that would break the file are left out.
    NodeSetExtras extras;
    extras.nodes[space.node_id(find("s=V"))].attributes = {
        {"Sound-1.a", "x\ny"}, {"", "1"}, {"2a", "2"}, {"a b", "3"}, {"\xC3\xA9", "4"}};
    const std::string text = write_nodeset(space, namespaces, extras).value();
    CHECK(has(text, " Sound-1.a=\"x&#10;y\" \xC3\xA9=\"4\">"));
}

TEST_CASE_METHOD(WriteFixture, "Attributes of every NodeClass are written")
{
    const std::string text = rewritten(
        type_text("UAVariableType", "i=1", "i=63", "<Value><Int32>3</Int32></Value>")
            .replace(0, 16, "<UAVariableType IsAbstract=\"true\" DataType=\"i=6\" ") +
        "<UAView NodeId=\"ns=1;i=2\" BrowseName=\"1:V\" ContainsNoLoops=\"true\" "
        "EventNotifier=\"1\"><References><Reference ReferenceType=\"i=35\" IsForward=\"false\">"
        "i=87</Reference></References></UAView>"
        "<UAMethod NodeId=\"ns=1;i=3\" BrowseName=\"1:M\" Executable=\"false\" "
        "MethodDeclarationId=\"ns=1;i=4\"><References><Reference ReferenceType=\"i=47\" "
        "IsForward=\"false\">i=85</Reference></References></UAMethod>"
        "<UAObject NodeId=\"ns=1;i=5\" BrowseName=\"0:7:a\" EventNotifier=\"5\"><References>"
        "<Reference ReferenceType=\"i=40\">i=58</Reference></References></UAObject>"
        "<UAReferenceType NodeId=\"ns=1;i=6\" BrowseName=\"1:R\" Symmetric=\"true\"><References>"
        "<Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=32</Reference>"
        "</References></UAReferenceType>");
    CHECK(has(text, "<UAVariableType NodeId=\"ns=1;i=1\" BrowseName=\"1:T1\" DataType=\"i=6\" "
                    "IsAbstract=\"true\">"));
    CHECK(has(text, "<UAView NodeId=\"ns=1;i=2\" BrowseName=\"1:V\" ContainsNoLoops=\"true\" "
                    "EventNotifier=\"1\">"));
    CHECK(has(text, "<UAMethod NodeId=\"ns=1;i=3\" BrowseName=\"1:M\" Executable=\"false\" "
                    "MethodDeclarationId=\"ns=1;i=4\">"));
    CHECK(has(text, "<UAObject NodeId=\"ns=1;i=5\" BrowseName=\"0:7:a\" EventNotifier=\"5\">"));
    CHECK(has(text, "<UAReferenceType NodeId=\"ns=1;i=6\" BrowseName=\"1:R\" Symmetric=\"true\">"));
    CHECK(write_nodeset(space, std::vector<std::uint16_t>{9}).error() == status::Bad_NotFound);
}

TEST_CASE_METHOD(WriteFixture, "Definitions are written with all that a field says")
{
    const std::string text = rewritten(
        structure_text("i=10", "i=22",
                       field_text("A", "i=12",
                                  "SymbolicName=\"Aa\" ValueRank=\"2\" ArrayDimensions=\"2,3\" "
                                  "MaxStringLength=\"8\"") +
                           field_text("B", "i=6", "AllowSubTypes=\"true\""),
                       "SymbolicName=\"Tt\"") +
        structure_text("i=11", "ns=1;i=10", field_text("C", "i=6")) +
        type_text("UADataType", "i=12", "ns=1;i=10") +
        structure_text("i=20", "i=12756", field_text("A", "i=6", "AllowSubTypes=\"true\""),
                       "IsUnion=\"true\"") +
        structure_text(
            "i=30", "i=7",
            "<Field Name=\"Low\" Value=\"0\"><DisplayName Locale=\"en\">Low</DisplayName>"
            "</Field><Field Name=\"High\" Value=\"1\"/>",
            "IsOptionSet=\"true\"") +
        type_text("UADataType", "i=40", "i=12"));
    CHECK(has(text, "<Definition Name=\"T\" SymbolicName=\"Tt\">"));
    CHECK(has(text, "<Field Name=\"A\" SymbolicName=\"Aa\" DataType=\"i=12\" ValueRank=\"2\" "
                    "ArrayDimensions=\"2,3\" MaxStringLength=\"8\"/>"));
    CHECK(has(text, "<Field Name=\"B\" DataType=\"i=6\" AllowSubTypes=\"true\"/>"));
    CHECK(has(text, "<Definition Name=\"T\">\n    <Field Name=\"C\" DataType=\"i=6\"/>"));
    CHECK(has(text, "<Definition Name=\"T\" IsUnion=\"true\">\n    <Field Name=\"A\" "
                    "DataType=\"i=6\" AllowSubTypes=\"true\"/>"));
    CHECK(has(text, "<Definition Name=\"T\" IsOptionSet=\"true\">\n    <Field Name=\"Low\" "
                    "Value=\"0\">\n      <DisplayName Locale=\"en\">Low</DisplayName>"));
    // Those that add nothing have no Definition.
    const auto own = text.substr(text.find("NodeId=\"ns=1;i=12\""));
    CHECK_FALSE(has(own.substr(0, own.find("</UADataType>")), "<Definition"));
    const auto last = text.substr(text.find("NodeId=\"ns=1;i=40\""));
    CHECK_FALSE(has(last.substr(0, last.find("</UADataType>")), "<Definition"));
}

} // namespace busbar::model::nodeset_write_test
