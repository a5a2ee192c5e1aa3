#include "nodeset_fixture.hpp"

namespace busbar::model::nodeset_value_errors_test {

namespace {

constexpr const char* any = "DataType=\"i=24\" ValueRank=\"-2\"";

/// An enumeration (T10) and structures with a field of each form: a union (T20), a matrix (T30),
/// one with itself (T40), one of a type that is nowhere (T50) and one of an enumeration (T60).
std::string types()
{
    return structure_text("i=10", "i=29",
                          "<Field Name=\"Off\" Value=\"0\"/><Field Name=\"On\" Value=\"7\"/>") +
           structure_text("i=20", "i=12756", field_text("A", "i=6") + field_text("B", "i=12"),
                          "IsUnion=\"true\"") +
           structure_text("i=30", "i=22", field_text("Grid", "i=4", "ValueRank=\"2\"")) +
           structure_text("i=40", "i=22", field_text("Again", "ns=1;i=40")) +
           structure_text("i=50", "i=22", field_text("What", "ns=1;i=99")) +
           structure_text("i=60", "i=22", field_text("State", "ns=1;i=10"));
}

std::string of_type(const std::string& id, const std::string& body)
{
    return "<ExtensionObject><TypeId><Identifier>ns=1;" + id + "</Identifier></TypeId><Body>" +
           body + "</Body></ExtensionObject>";
}

struct FaultyValue : NodeSetFixture {
    /// Says what is wrong with a <Value>, after the name of the file and of the node.
    std::string fault(const std::string& xml, const NodeSetLimits& limits = {})
    {
        const std::string where = "t.xml:3: ns=1;s=V: found ";
        const std::string error = error_of(variable_text("s=V", any, xml) + types(), limits);
        CHECK(error.substr(0, where.size()) == where);
        return error.substr(std::min(where.size(), error.size()));
    }
};

} // namespace

TEST_CASE_METHOD(FaultyValue, "Values that are no text of their type are refused")
{
    CHECK(fault("<Boolean>maybe</Boolean>") == "<Boolean> \"maybe\", expected true or false");
    CHECK(fault("<Int32>+-1</Int32>") ==
          "<Int32> \"+-1\", expected a number in the range of its type");
    CHECK(fault("<Byte>256</Byte>") ==
          "<Byte> \"256\", expected a number in the range of its type");
    CHECK(fault("<Double>INFINITE</Double>") ==
          "<Double> \"INFINITE\", expected a number in the range of its type");
    CHECK(fault("<Guid>72962B91-FA75</Guid>") == "<Guid> \"72962B91-FA75\", expected a Guid");
    CHECK(fault("<Guid><String>x</String></Guid>") == "<Guid> \"\", expected a Guid");
    CHECK(fault("<ByteString>A*==</ByteString>") == "<ByteString> \"A*==\", expected base64");
    CHECK(fault("<DateTime>soon</DateTime>") ==
          "<DateTime> \"soon\", expected a time such as 2026-05-01T00:00:00Z");
    CHECK(fault("<NodeId><Identifier>i=x</Identifier></NodeId>") ==
          "<Identifier> \"i=x\", expected a NodeId");
    CHECK(fault("<StatusCode><Code>Good</Code></StatusCode>") ==
          "<Code> \"Good\", expected a number in the range of its type");
    CHECK(fault("<QualifiedName><NamespaceIndex>2</NamespaceIndex></QualifiedName>") ==
          "<QualifiedName> \"\", expected a namespace index of the file's <NamespaceUris>, not 2");
    // Of two faults the first is told.
    CHECK(fault("<ListOfBoolean><Boolean>a</Boolean><Boolean>b</Boolean></ListOfBoolean>") ==
          "<Boolean> \"a\", expected true or false");
}

TEST_CASE_METHOD(FaultyValue, "ExpandedNodeIds of no sense are refused")
{
    const char* const id =
        GENERATE("svr=x;i=1", "nsu=urn:a;ns=1;i=1", "nsu=urn:a", "svr=1", "i=x", "svr=-1;i=1");
    CHECK(fault("<ExpandedNodeId><Identifier>" + std::string{id} +
                "</Identifier></ExpandedNodeId>") ==
          "<Identifier> \"" + std::string{id} + "\", expected an ExpandedNodeId");
}

TEST_CASE_METHOD(FaultyValue, "Matrices that lack something are refused")
{
    const std::string sizes = "<Dimensions><UInt32>1</UInt32><UInt32>1</UInt32></Dimensions>";
    const std::string parts = "<Matrix> \"\", expected <Dimensions> and <Elements>";
    CHECK(fault("<Matrix/>") == parts);
    CHECK(fault("<Matrix>" + sizes + "</Matrix>") == parts);
    CHECK(fault("<Matrix>" + sizes + "<Elements/></Matrix>") == parts);
    CHECK(fault("<Matrix><Elements><Int32>1</Int32></Elements></Matrix>") == parts);
    CHECK(fault("<Matrix><Dimensions><UInt32>1</UInt32></Dimensions><Elements><Int32>1</Int32>"
                "</Elements></Matrix>") ==
          "<Matrix> \"\", expected as many <Elements> as the two or more <Dimensions> say");
    CHECK(fault("<Matrix>" + sizes + "<Elements><Thing>1</Thing></Elements></Matrix>") ==
          "<Elements> \"\", expected a built-in type");
    // As a field of a structure.
    CHECK(fault(of_type("i=30", "<T30><Grid>" + sizes + "</Grid></T30>")) ==
          "<Grid> \"\", expected <Dimensions> and <Elements>");
    CHECK(fault(of_type("i=30", "<T30><Grid><Elements/></Grid></T30>")) ==
          "<Grid> \"\", expected <Dimensions> and <Elements>");
    CHECK(fault(of_type("i=30", "<T30><Grid>" + sizes + "<Elements/></Grid></T30>")) ==
          "<Grid> \"\", expected as many <Elements> as the two or more <Dimensions> say");
    CHECK(fault(of_type("i=30", "<T30><Grid><Dimensions><Int32>1</Int32></Dimensions>"
                                "<Elements><Int16>1</Int16></Elements></Grid></T30>")) ==
          "<Grid> \"\", expected as many <Elements> as the two or more <Dimensions> say");
    CHECK(fault(of_type("i=30", "<T30><Grid><Dimensions><Int32>-1</Int32><Int32>-1</Int32>"
                                "</Dimensions><Elements><Int16>1</Int16></Elements></Grid>"
                                "</T30>")) ==
          "<Grid> \"\", expected as many <Elements> as the two or more <Dimensions> say");
}

TEST_CASE_METHOD(FaultyValue, "Structures that are not as their definition says are refused")
{
    const std::string choice = "<T20> \"\", expected one of the 2 fields of the union";
    CHECK(fault(of_type("i=20", "<T20><SwitchField>3</SwitchField><A>1</A></T20>")) == choice);
    CHECK(fault(of_type("i=20", "<T20><C>1</C></T20>")) == choice);
    CHECK(fault(of_type("i=20", "<T20><SwitchField>A</SwitchField></T20>")) ==
          "<SwitchField> \"A\", expected a number in the range of its type");
    CHECK(fault(of_type("i=50", "<T50><What>1</What></T50>")) ==
          "<What> \"1\", expected a field whose DataType is known");
    CHECK(fault(of_type("i=60", "<T60><State>Onn</State></T60>")) ==
          "<State> \"Onn\", expected a value of the enumeration such as Name_3");
    CHECK(fault(of_type("i=60", "<T60><State>On_x</State></T60>")) ==
          "<State> \"On_x\", expected a value of the enumeration such as Name_3");
}

TEST_CASE_METHOD(FaultyValue, "Values may be so deep and no deeper")
{
    // T40 has a T40, whatever the file says.
    CHECK(fault(of_type("i=40", "<T40/>")) == "<Again> \"\", expected structures less deep");
    NodeSetLimits limits;
    limits.max_value_depth = 1000;
    std::string xml = "<Int32>1</Int32>";
    for (int i = 0; i < 40; ++i) {
        xml = "<Variant><Value>" + xml + "</Value></Variant>";
    }
    CHECK(fault(xml, limits) == "<Variant> \"\", expected values less deep");
}

TEST_CASE_METHOD(FaultyValue, "A structure has at most 32 optional fields")
{
    const auto optional = [](int count) {
        std::string fields;
        for (int i = 0; i < count; ++i) {
            fields += field_text("F" + std::to_string(i), "i=3", "IsOptional=\"true\"");
        }
        return structure_text("i=70", "i=22", fields);
    };
    const std::string value = of_type("i=70", "<T70><F0>5</F0><F31>6</F31></T70>");
    CHECK(error_of(variable_text("s=V", any, value) + optional(33)) ==
          "t.xml:3: ns=1;s=V: found <T70> \"\", expected a structure of at most 32 optional "
          "fields");
    const NodeSetSummary summary = load(variable_text("s=V", any, value) + optional(32));
    const Variant loaded = this->value("s=V");
    REQUIRE(loaded.get_if<ExtensionObject>() != nullptr);
    const unsigned char bytes[] = {1, 0, 0, 0x80, 5, 6};
    CHECK(*loaded.get_if<ExtensionObject>() ==
          ExtensionObject::from_binary(loaded.get_if<ExtensionObject>()->encoding_id(),
                                       ByteString{std::as_bytes(std::span{bytes})}));
    check_write_back(space, AddressSpace{}, {1}, summary);
}

} // namespace busbar::model::nodeset_value_errors_test
