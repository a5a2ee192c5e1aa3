#include "nodeset_fixture.hpp"

#include <limits>

#include <busbar/binary/codec.hpp>

namespace busbar::model::nodeset_value_test {

namespace {

constexpr const char* any = "DataType=\"i=24\" ValueRank=\"-2\"";

/// Fields of the type Byte.
std::string numbered_fields(int count)
{
    std::string fields;
    for (int i = 0; i < count; ++i) {
        fields += "<Field Name=\"F" + std::to_string(i) + "\" DataType=\"i=3\"/>";
    }
    return fields;
}

/// Types of values: an enumeration (i=10), a structure with optional fields (i=20), a union (i=30),
/// one that nests them all (i=40), one with subtyped fields (i=50), an option set (i=60), one of
/// many fields (i=70) and one whose fields are all left out (i=80).
std::string types()
{
    return type_text("UADataType", "i=10", "i=29",
                     "<Definition Name=\"1:State\"><Field Name=\"Off\" Value=\"0\"/>"
                     "<Field Name=\"On\" Value=\"7\"><DisplayName Locale=\"de\">An</DisplayName>"
                     "<Description>Runs</Description></Field></Definition>") +
           type_text("UADataType", "i=20", "i=22",
                     "<Definition Name=\"1:Opt\"><Field Name=\"A\" DataType=\"i=6\"/>"
                     "<Field Name=\"B\" DataType=\"i=12\" IsOptional=\"true\"/>"
                     "<Field Name=\"C\" DataType=\"ns=1;i=10\" IsOptional=\"true\"/>"
                     "</Definition>") +
           encoding_text("i=21", "i=20") +
           type_text("UADataType", "i=30", "i=12756",
                     "<Definition Name=\"1:Either\" IsUnion=\"true\">"
                     "<Field Name=\"Number\" DataType=\"i=11\"/>"
                     "<Field Name=\"Text\" DataType=\"i=12\"/></Definition>") +
           encoding_text("i=31", "i=30") +
           type_text("UADataType", "i=40", "i=22",
                     "<Definition Name=\"1:Nest\"><Field Name=\"Opts\" DataType=\"ns=1;i=20\" "
                     "ValueRank=\"1\"/><Field Name=\"Either\" DataType=\"ns=1;i=30\"/>"
                     "<Field Name=\"Grid\" DataType=\"i=4\" ValueRank=\"2\"/>"
                     "<Field Name=\"Node\" DataType=\"i=17\"/>"
                     "<Field Name=\"Any\" DataType=\"i=24\"/>"
                     "<Field Name=\"Open\" DataType=\"i=22\"/></Definition>") +
           encoding_text("i=41", "i=40") +
           type_text("UADataType", "i=50", "i=22",
                     "<Definition Name=\"1:Sub\"><Field Name=\"Opt\" DataType=\"ns=1;i=20\" "
                     "AllowSubTypes=\"true\"/><Field Name=\"Number\" DataType=\"i=6\" "
                     "AllowSubTypes=\"true\"/></Definition>") +
           encoding_text("i=51", "i=50") +
           type_text("UADataType", "i=60", "i=12755",
                     "<Definition Name=\"1:Bits\" IsOptionSet=\"true\">"
                     "<Field Name=\"Low\" Value=\"0\"/><Field Name=\"High\" Value=\"1\"/>"
                     "</Definition>") +
           type_text("UADataType", "i=70", "i=22",
                     "<Definition Name=\"1:Long\">" + numbered_fields(20) + "</Definition>") +
           type_text("UADataType", "i=80", "i=22",
                     "<Definition Name=\"1:Zeros\"><Field Name=\"Flag\" DataType=\"i=1\"/>"
                     "<Field Name=\"When\" DataType=\"i=13\"/>"
                     "<Field Name=\"Guid\" DataType=\"i=14\"/>"
                     "<Field Name=\"Real\" DataType=\"i=11\"/>"
                     "<Field Name=\"State\" DataType=\"ns=1;i=10\"/>"
                     "<Field Name=\"Any\" DataType=\"i=26\"/>"
                     "<Field Name=\"List\" DataType=\"i=3\" ValueRank=\"1\"/></Definition>");
}

std::string object(const std::string& type_id, const std::string& body)
{
    return "<ExtensionObject><TypeId><Identifier>" + type_id + "</Identifier></TypeId><Body>" +
           body + "</Body></ExtensionObject>";
}

template <typename... T>
std::vector<std::byte> bytes(const T&... values)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    (encode(writer, values), ...);
    return sink.take(writer.written());
}

struct ValueFixture : NodeSetFixture {
    /// The value of a Variable that has this <Value>; it must re-read equal.
    Variant read(const std::string& xml)
    {
        AddressSpace other;
        REQUIRE(other.add_namespace("urn:other"));
        std::swap(space, other);
        // Index 1 of the file is 2 here.
        const NodeSetSummary summary = load(types() + variable_text("s=V", any, xml));
        check_write_back(space, AddressSpace{}, {2}, summary);
        return value("s=V");
    }
    std::vector<std::byte> body(const std::string& xml)
    {
        const Variant found = read(xml);
        const auto* const structure = found.get_if<ExtensionObject>();
        REQUIRE(structure != nullptr);
        REQUIRE(structure->body() == ExtensionObject::Body::Binary);
        encoding = structure->encoding_id();
        const auto span = structure->binary().span();
        return {span.begin(), span.end()};
    }
    NodeId encoding;
};

} // namespace

TEST_CASE_METHOD(ValueFixture, "Scalars and arrays of every built-in type are read")
{
    CHECK(read("<Boolean> true\n</Boolean>") == Variant{true});
    CHECK(read("<SByte>-128</SByte>") == Variant{std::int8_t{-128}});
    CHECK(read("<UInt64>+18446744073709551615</UInt64>") == Variant{UINT64_MAX});
    CHECK(read("<Float>-INF</Float>") == Variant{-std::numeric_limits<float>::infinity()});
    CHECK(read("<Double>NaN</Double>") == Variant{std::numeric_limits<double>::quiet_NaN()});
    CHECK(read("<Double>0.1</Double>") == Variant{0.1});
    CHECK(read("<String> a&lt;b\t\xC3\xA9 </String>") == Variant{" a<b\t\xC3\xA9 "});
    CHECK(read("<String>a&#13;&#10;b</String>") == Variant{"a\r\nb"});
    CHECK(read("<String><![CDATA[<x>]]><!-- no --></String>") == Variant{"<x>"});
    CHECK(read("<ByteString> AQ\nID </ByteString>") ==
          Variant{ByteString{std::as_bytes(std::span{"\1\2\3", 3})}});
    CHECK(read("<Guid><String>72962B91-FA75-4AE6-8D28-B404DC7DAF63</String></Guid>") ==
          Variant{*Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63")});
    CHECK(read("<StatusCode><Code>2147483648</Code></StatusCode>") ==
          Variant{StatusCode{0x80000000U}});
    CHECK(read("<XmlElement><a b=\"1\"> <c>x</c></a></XmlElement>").type() ==
          BuiltInType::XmlElement);
    CHECK(read("<ListOfString><String>a</String><String/></ListOfString>") ==
          Variant{Array<String>{String{"a"}, String{}}});
    CHECK(read("<ListOfInt32/>") == Variant{Array<std::int32_t>{std::initializer_list<int>{}}});
}

TEST_CASE_METHOD(ValueFixture, "Times are read with fraction and offset")
{
    const auto time = [&](const std::string& text) {
        return read("<DateTime>" + text + "</DateTime>").value_or(DateTime{-1}).ticks;
    };
    const std::int64_t base = DateTime::from_unix_seconds(1'767'225'600).ticks;
    CHECK(time("2026-01-01T00:00:00Z") == base);
    CHECK(time("2026-01-01") == base);
    CHECK(time("2026-01-01T00:00:00.1234567Z") == base + 1'234'567);
    CHECK(time("2026-01-01T02:00:00+02:00") == base);
    CHECK(time("2025-12-31T22:30:00-01:30") == base);
    CHECK(time("0001-01-01T00:00:00Z") == 0);
    CHECK(time("9999-12-31T23:59:59Z") == INT64_MAX);
    for (const char* const bad :
         {"", "2026", "2026-13-01", "2026-01-01T", "2026-01-01T1:00:00Z", "2026-01-01T00:00:00.Z",
          "2026-01-01T00:00:00+2", "2026-02-30T00:00:00Z", "2026-01-01T00:00:00Zx", "-026-01-01"}) {
        INFO(bad);
        CHECK_FALSE(NodeSetFixture{}
                        .error_of(variable_text("s=V", any,
                                                "<DateTime>" + std::string{bad} + "</DateTime>"))
                        .empty());
    }
}

TEST_CASE_METHOD(ValueFixture, "Namespace indices in values become those of the server")
{
    const auto id = [](const std::string& name, const std::string& text) {
        return "<" + name + "><Identifier>" + text + "</Identifier></" + name + ">";
    };
    CHECK(read(id("NodeId", "ns=1;s=x")) == Variant{NodeId{2, "x"}});
    CHECK(read(id("ExpandedNodeId", "ns=1;i=4")) == Variant{ExpandedNodeId{NodeId{2, 4U}}});
    CHECK(read(id("ExpandedNodeId", "svr=3;nsu=urn:far;i=4")) ==
          Variant{ExpandedNodeId{NodeId{0, 4U}, "urn:far", 3}});
    CHECK(read(id("ExpandedNodeId", "svr=3;ns=1;i=4")) ==
          Variant{ExpandedNodeId{NodeId{1, 4U}, {}, 3}});
    const std::string name = "<QualifiedName><NamespaceIndex>1</NamespaceIndex><Name>q</Name>"
                             "</QualifiedName>";
    CHECK(read(name) == Variant{QualifiedName{2, "q"}});
    CHECK(read("<ListOfVariant><Variant><Value>" + name + "</Value></Variant><Variant/>" +
               "</ListOfVariant>") ==
          Variant{Array<Variant>{Variant{QualifiedName{2, "q"}}, Variant{}}});
    CHECK(read("<DataValue><Value>" + name + "</Value><StatusCode><Code>1</Code></StatusCode>" +
               "</DataValue>") ==
          Variant{DataValue{Variant{QualifiedName{2, "q"}}, StatusCode{1}}});
    CHECK(NodeSetFixture{}.error_of(variable_text("s=V", any, id("NodeId", "ns=2;i=1"))) ==
          "t.xml:3: ns=1;s=V: found <Identifier> \"ns=2;i=1\", expected a namespace index of the "
          "file's <NamespaceUris>, not 2");
}

TEST_CASE_METHOD(ValueFixture, "Matrices have their dimensions")
{
    const std::string elements = "<Elements><Int32>1</Int32><Int32>2</Int32></Elements></Matrix>";
    const auto sizes = [](const std::string& a, const std::string& b) {
        return "<Matrix><Dimensions><UInt32>" + a + "</UInt32><UInt32>" + b +
               "</UInt32></Dimensions>";
    };
    CHECK(read(sizes("2", "1") + elements) ==
          Variant::matrix(Array<std::int32_t>{1, 2}, Array<std::uint32_t>{2, 1}));
    const auto error = [&](const std::string& xml) {
        return NodeSetFixture{}.error_of(variable_text("s=V", any, xml));
    };
    const std::string count = "t.xml:3: ns=1;s=V: found <Matrix> \"\", expected as many <Elements> "
                              "as the two or more <Dimensions> say";
    CHECK(error(sizes("2", "2") + elements) == count);
    CHECK(error(sizes("4294967295", "4294967295") + elements) == count);
}

TEST_CASE_METHOD(ValueFixture, "Structures are encoded by their definitions")
{
    CHECK(
        body(object("ns=1;i=21", "<Opt><EncodingMask>2</EncodingMask><A>5</A><C>On_7</C></Opt>")) ==
        bytes(2U, 5, 7));
    CHECK(encoding == NodeId{2, 21U});
    // Without a mask by what is there; by the DataType's id.
    CHECK(body(object("ns=1;i=20", "<Opt><A>5</A><B>b</B></Opt>")) == bytes(1U, 5, String{"b"}));
    CHECK(encoding == NodeId{2, 21U});
    CHECK(
        body(object("ns=1;i=31", "<Either><SwitchField>2</SwitchField><Text>t</Text></Either>")) ==
        bytes(2U, String{"t"}));
    CHECK(body(object("ns=1;i=31", "<Either><Number>1</Number></Either>")) == bytes(1U, 1.0));
    CHECK(body(object("ns=1;i=31", "<Either/>")) == bytes(0U));
    const auto opt_body = bytes(0U, 1);
    const ExtensionObject opt =
        ExtensionObject::from_binary(NodeId{2, 21U}, ByteString{std::span{opt_body}});
    CHECK(body(object("ns=1;i=51", "<Sub><Opt><TypeId><Identifier>ns=1;i=21</Identifier></TypeId>"
                                   "<Body><Opt><A>1</A></Opt></Body></Opt>"
                                   "<Number><Value><Byte>3</Byte></Value></Number></Sub>")) ==
          bytes(opt, Variant{std::uint8_t{3}}));
}

TEST_CASE_METHOD(ValueFixture, "Structures in structures are encoded")
{
    const std::string nest =
        "<Nest><Opts><Opt><A>1</A></Opt><Opt><A>2</A><C>Off</C></Opt></Opts>"
        "<Either><Text></Text><SwitchField>2</SwitchField></Either>"
        "<Grid><Dimensions><Int32>1</Int32><Int32>2</Int32></Dimensions>"
        "<Elements><Int16>3</Int16><Int16>4</Int16></Elements></Grid>"
        "<Node><Identifier>ns=1;i=9</Identifier></Node>"
        "<Any><Value><ListOfInt32><Int32>6</Int32></ListOfInt32></Value></Any></Nest>";
    CHECK(body(object("ns=1;i=41", nest)) ==
          bytes(2, 0U, 1, 2U, 2, 0, 2U, String{}, Array<std::int32_t>{1, 2}, std::int16_t{3},
                std::int16_t{4}, NodeId{2, 9U}, Variant{Array<std::int32_t>{6}},
                ExtensionObject{}));
    // Everything left out: nulls and zeros.
    CHECK(body(object("ns=1;i=41", "<Nest/>")) ==
          bytes(-1, 0U, -1, NodeId{}, Variant{}, ExtensionObject{}));
}

TEST_CASE_METHOD(ValueFixture, "What a value leaves out is null or zero")
{
    const std::string nil = " xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
                            "xsi:nil=\"true\"";
    CHECK(read("<ByteString" + nil + "/>") == Variant{ByteString{}});
    CHECK(read("<String" + nil + "/>") == Variant{String{}});
    CHECK(read("<XmlElement" + nil + "/>") == Variant{XmlElement{}});
    CHECK(read("<ListOfInt32" + nil + "/>") == Variant{Array<std::int32_t>{}});
    CHECK(read("<Null/>").is_null());
    CHECK(read("<Variant/>").is_null());
    CHECK(read("<Variant><Value/></Variant>").is_null());
    CHECK(read("<Double>+INF</Double>") == Variant{std::numeric_limits<double>::infinity()});
    CHECK(read("<Guid>72962B91-FA75-4AE6-8D28-B404DC7DAF63</Guid>") ==
          Variant{*Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63")});
    CHECK(read("<NodeId/>") == Variant{NodeId{}});
    CHECK(read("<ExpandedNodeId><Identifier/></ExpandedNodeId>") == Variant{ExpandedNodeId{}});
    CHECK(read("<LocalizedText><Text>t</Text></LocalizedText>") ==
          Variant{LocalizedText{String{}, String{"t"}}});
    CHECK(read("<LocalizedText><Locale>en</Locale></LocalizedText>") ==
          Variant{LocalizedText{String{"en"}, String{}}});
    CHECK(read("<QualifiedName/>") == Variant{QualifiedName{}});
    const auto zeros = bytes(false, DateTime{}, Guid{}, 0.0, 0, Variant{}, -1);
    CHECK(body(object("ns=1;i=80", "<Zeros/>")) == zeros);
    CHECK(body(object("ns=1;i=80", "<Zeros><Flag" + nil + "/><When/><Guid/><Real/><State/>" +
                                       "<List" + nil + "/></Zeros>")) == zeros);
    CHECK(body(object("ns=1;i=80", "<Zeros><Flag>1</Flag><State>On</State>"
                                   "<List><![CDATA[]]></List></Zeros>")) ==
          bytes(true, DateTime{}, Guid{}, 0.0, 7, Variant{}, 0));
    // A list without elements is empty and not null, in a structure as elsewhere.
    CHECK(body(object("ns=1;i=80", "<Zeros><List/></Zeros>")) ==
          bytes(false, DateTime{}, Guid{}, 0.0, 0, Variant{}, 0));
}

TEST_CASE_METHOD(ValueFixture, "Option sets and structures of many fields are encoded")
{
    CHECK(
        body(object("ns=1;i=60", "<Bits><Value>AQ==</Value><ValidBits>Aw==</ValidBits></Bits>")) ==
        bytes(ByteString{std::as_bytes(std::span{"\1", 1})},
              ByteString{std::as_bytes(std::span{"\3", 1})}));
    CHECK(encoding == NodeId{2, 60U});
    CHECK(body(object("ns=1;i=60", "<Bits/>")) == bytes(ByteString{}, ByteString{}));
    // In any order.
    std::string fields;
    std::vector<std::byte> expected;
    for (int i = 0; i < 20; ++i) {
        const std::string name = "F" + std::to_string(19 - i);
        fields += i == 3 ? "" : "<" + name + ">" + std::to_string(19 - i) + "</" + name + ">";
        expected.push_back(static_cast<std::byte>(i == 16 ? 0 : i));
    }
    CHECK(body(object("ns=1;i=70", "<Long>" + fields + "</Long>")) == expected);
}

TEST_CASE_METHOD(ValueFixture, "Structures without a TypeId are known by their name")
{
    CHECK(body("<ExtensionObject><Body><T20><A>5</A></T20></Body></ExtensionObject>") ==
          bytes(0U, 5));
    CHECK(encoding == NodeId{2, 21U});
    CHECK(body(object("", "<T20><A>6</A></T20>")) == bytes(0U, 6));
    const Variant unknown = read("<ExtensionObject><Body><Opts>1</Opts></Body></ExtensionObject>");
    REQUIRE(unknown.get_if<ExtensionObject>() != nullptr);
    CHECK(unknown.get_if<ExtensionObject>()->xml().view() == "<Opts>1</Opts>");
    // An id of a DataType that is no structure makes none either.
    const Variant number = read(object("ns=1;i=10", "<State>7</State>"));
    REQUIRE(number.get_if<ExtensionObject>() != nullptr);
    CHECK(number.get_if<ExtensionObject>()->encoding_id() == NodeId{2, 10U});
    CHECK(number.get_if<ExtensionObject>()->xml().view() == "<State>7</State>");
    const Variant bare = read("<ExtensionObject><TypeId><Identifier>ns=1;i=21</Identifier>"
                              "</TypeId></ExtensionObject>");
    CHECK(bare == Variant{ExtensionObject::from_id(NodeId{2, 21U})});
}

TEST_CASE_METHOD(ValueFixture, "Elements of XML have the SymbolicNames of types")
{
    // Default XML of 3DVector, for which the AddressSpace has no node.
    CHECK(body(object("i=18853", "<ThreeDVector><X>1</X><Y>2</Y><Z>3</Z></ThreeDVector>")) ==
          bytes(1.0, 2.0, 3.0));
    CHECK(encoding == NodeId{0, id::ThreeDVector_Encoding_DefaultBinary});
    load("<UADataType NodeId=\"ns=1;i=90\" BrowseName=\"1:2 Sides\" SymbolicName=\"TwoSides\">"
         "<References><Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=22"
         "</Reference></References><Definition Name=\"1:2 Sides\">" +
         field_text("Left", "i=6") + "</Definition></UADataType>\n" +
         encoding_text("i=91", "i=90") +
         variable_text("s=Sides", "DataType=\"ns=1;i=90\"",
                       object("ns=1;i=999", "<TwoSides><Left>7</Left></TwoSides>")));
    const Variant sides = value("s=Sides");
    REQUIRE(sides.get_if<ExtensionObject>() != nullptr);
    CHECK(sides.get_if<ExtensionObject>()->encoding_id().numeric() == 91);
}

TEST_CASE_METHOD(ValueFixture, "A BrowseName goes before the SymbolicName of another type")
{
    const auto type = [](int id, const std::string& names) {
        const std::string number = std::to_string(id);
        return "<UADataType NodeId=\"ns=1;i=" + number + "\" " + names +
               "><References><Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=22"
               "</Reference></References><Definition Name=\"1:D\">" +
               field_text("Left", "i=6") + "</Definition></UADataType>\n" +
               encoding_text("i=" + std::to_string(id + 1), "i=" + number);
    };
    load(type(90, "BrowseName=\"1:First\" SymbolicName=\"Sides\"") +
         type(92, "BrowseName=\"1:Sides\"") +
         variable_text("s=Sides", "DataType=\"i=22\"",
                       object("ns=1;i=999", "<Sides><Left>7</Left></Sides>")));
    const Variant sides = value("s=Sides");
    REQUIRE(sides.get_if<ExtensionObject>() != nullptr);
    CHECK(sides.get_if<ExtensionObject>()->encoding_id().numeric() == 93);
}

TEST_CASE_METHOD(ValueFixture, "What is not known is kept as it is")
{
    const Variant xml = read(object("ns=1;i=999", "<What xmlns=\"urn:w\"><Ever>1</Ever></What>"));
    REQUIRE(xml.get_if<ExtensionObject>() != nullptr);
    CHECK(xml.get_if<ExtensionObject>()->encoding_id() == NodeId{2, 999U});
    CHECK(xml.get_if<ExtensionObject>()->xml().view() ==
          "<What xmlns=\"urn:w\"><Ever>1</Ever></What>");
    const Variant binary = read(object("ns=1;i=999", "<ByteString>AQI=</ByteString>"));
    CHECK(binary == Variant{ExtensionObject::from_binary(
                        NodeId{2, 999U}, ByteString{std::as_bytes(std::span{"\1\2", 2})})});
    CHECK(read("<ListOfExtensionObject><ExtensionObject/></ListOfExtensionObject>") ==
          Variant{Array<ExtensionObject>{ExtensionObject{}}});
}

} // namespace busbar::model::nodeset_value_test
