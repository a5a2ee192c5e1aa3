#include "nodeset_fixture.hpp"

#include <model/graft.hpp>

namespace busbar::model::nodeset_errors_test {

namespace {

const std::string below_objects =
    "<Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>";
const std::string base_object = "<Reference ReferenceType=\"i=40\">i=58</Reference>";

std::string object(const std::string& id, const std::string& references)
{
    return "<UAObject NodeId=\"ns=1;" + id + "\" BrowseName=\"1:" + id + "\"><References>" +
           references + "</References></UAObject>\n";
}

std::string reference(const std::string& type, const std::string& target, bool is_forward = true)
{
    return "<Reference ReferenceType=\"" + type + "\"" +
           (is_forward ? "" : " IsForward=\"false\"") + ">" + target + "</Reference>";
}

std::string repeated(std::size_t count, const std::string& text)
{
    std::string result;
    for (std::size_t i = 0; i < count; ++i) {
        result += text;
    }
    return result;
}

} // namespace

TEST_CASE_METHOD(NodeSetFixture, "A file with a fault changes nothing and says what is wrong")
{
    // Nodes before and after the fault are sound.
    const auto error = [&](const std::string& fault) {
        return error_of(object("s=A", below_objects + base_object) + fault +
                        object("s=Z", below_objects + base_object));
    };
    const std::string nowhere = ", which is in no file and not in the address space";
    CHECK(error(object("s=B", below_objects)) ==
          "t.xml:4: ns=1;s=B: found an Object without HasTypeDefinition");
    CHECK(error(object("s=B", below_objects + reference("i=40", "i=99999"))) ==
          "t.xml:4: ns=1;s=B: found the type definition i=99999, which is in no file and not in "
          "the address space, whose namespace 0 may have been built without it");
    CHECK(error(object("s=B", reference("i=35", "ns=1;i=9", false) + base_object)) ==
          "t.xml:4: ns=1;s=B: found a reference to nsu=urn:t;i=9" + nowhere);
    CHECK(error(object("s=B", below_objects + reference("i=40", "ns=1;i=9"))) ==
          "t.xml:4: ns=1;s=B: found the type definition nsu=urn:t;i=9, which is in no file and not "
          "in the address space");
    CHECK(error(object("s=B", below_objects + reference("i=40", "i=63"))) ==
          "t.xml:4: ns=1;s=B: found the type definition i=63, which is a VariableType, expected an "
          "ObjectType");
    CHECK(error(object("s=B", base_object + reference("i=40", "i=61"))) ==
          "t.xml:4: ns=1;s=B: found the type definition i=61, expected only i=58");
    CHECK(error(object("s=B", base_object + reference("ns=1;i=9", "ns=1;s=A"))) ==
          "t.xml:4: ns=1;s=B: found the ReferenceType nsu=urn:t;i=9" + nowhere);
    CHECK(error(object("s=B", base_object + reference("i=58", "ns=1;s=A"))) ==
          "t.xml:4: ns=1;s=B: found the ReferenceType i=58, which is an ObjectType");
    CHECK(error(object("s=B", base_object + reference("i=33", "ns=1;s=A"))) ==
          "t.xml:4: ns=1;s=B: found a reference of the abstract ReferenceType i=33");
    CHECK(error(object("s=B", base_object + reference("i=35", "ns=1;s=B"))) ==
          "t.xml:4: ns=1;s=B: found a hierarchical reference from the node to itself");
    CHECK(error(variable_text("s=B", "DataType=\"ns=1;i=9\"", "")) ==
          "t.xml:4: ns=1;s=B: found the DataType nsu=urn:t;i=9" + nowhere);
    CHECK(error(variable_text("s=B", "ValueRank=\"-4\"", "")) ==
          "t.xml:4: ns=1;s=B: found ValueRank=-4, expected -3 or more");
    CHECK(error(variable_text("s=B", "DataType=\"i=6\"", "\n<Int32>x</Int32>")) ==
          "t.xml:5: ns=1;s=B: found <Int32> \"x\", expected a number in the range of its type");
    CHECK(error(variable_text("s=B", "", "<Int33>1</Int33>")) ==
          "t.xml:4: ns=1;s=B: found <Int33> \"1\", expected a built-in type");
    CHECK(error(object("s=A", base_object)) == "t.xml:4: ns=1;s=A: the node is already at t.xml:3");
    CHECK(error("<UAObject NodeId=\"i=85\" BrowseName=\"Objects\" EventNotifier=\"x\"/>") ==
          "t.xml:4: i=85: found EventNotifier=\"x\", expected a number in the range of the "
          "attribute");
}

TEST_CASE_METHOD(NodeSetFixture, "Types have one supertype and make no circle")
{
    CHECK(error_of("<UAObjectType NodeId=\"ns=1;i=1\" BrowseName=\"1:T\"/>") ==
          "t.xml:3: ns=1;i=1: found an ObjectType without supertype");
    CHECK(error_of(type_text("UAObjectType", "i=1", "i=62")) ==
          "t.xml:3: ns=1;i=1: found a HasSubtype reference from a VariableType to an ObjectType, "
          "expected types of one NodeClass");
    CHECK(error_of(type_text("UAObjectType", "i=1", "ns=1;i=2")) ==
          "t.xml:3: ns=1;i=1: found a HasSubtype reference to nsu=urn:t;i=2, which is in no file "
          "and not in the address space");
    CHECK(error_of(type_text("UAObjectType", "i=1", "i=58") +
                   type_text("UAObjectType", "i=2",
                             "i=58</Reference><Reference ReferenceType=\"i=45\">ns=1;i=1")) ==
          "t.xml:4: ns=1;i=2: found the supertype nsu=urn:t;i=2, expected only i=58");
    CHECK(
        error_of(type_text("UADataType", "i=1", "ns=1;i=2") +
                 type_text("UADataType", "i=2", "ns=1;i=1")) ==
        "t.xml:3: ns=1;i=1: found HasSubtype references in a circle or more than 100 levels deep");
    CHECK_FALSE(error_of(type_text("UAReferenceType", "i=1", "ns=1;i=1")).empty());
    NodeSetLimits limits;
    limits.max_type_levels = 2;
    const std::string three = type_text("UAObjectType", "i=3", "ns=1;i=2") +
                              type_text("UAObjectType", "i=2", "ns=1;i=1") +
                              type_text("UAObjectType", "i=1", "i=58");
    CHECK_FALSE(error_of(three, limits).empty());
    CHECK(load(three).node_count == 3);
    CHECK(space.is_subtype_of(find("i=3"), find("i=1")));
    CHECK(space.is_subtype_of(find("i=3"), id::BaseObjectType));
}

TEST_CASE_METHOD(NodeSetFixture, "HasChild makes no circle, Organizes may")
{
    const auto circle = [](const std::string& type) {
        return object("s=A", base_object + reference(type, "ns=1;s=B")) +
               object("s=B", base_object + reference(type, "ns=1;s=A"));
    };
    CHECK(error_of(circle("i=47")) ==
          "t.xml:3: ns=1;s=A: found HasChild references that lead back to the node or to one above "
          "it");
    const NodeSetSummary summary = load(circle("i=35"));
    check_write_back(space, AddressSpace{}, {1}, summary);
}

TEST_CASE_METHOD(NodeSetFixture, "References of other types may lead nowhere and are noted")
{
    const NodeSetSummary summary =
        load(object("s=A", below_objects + base_object + reference("i=39", "ns=1;i=9")) +
             structure_text("i=1", "i=22", "\n" + field_text("F", "ns=1;i=8")));
    REQUIRE(summary.notes.size() == 2);
    CHECK(text(summary.notes[1]) == "t.xml:3: ns=1;s=A: found a reference to nsu=urn:t;i=9, which "
                                    "is in no file and not in the address space");
    CHECK(text(summary.notes[0]) ==
          "t.xml:5: ns=1;i=1: found the field \"F\" of the DataType nsu=urn:t;i=8, which is in no "
          "file and not in the address space; clients cannot read values with it");
    CHECK(summary.repairs.empty());
}

TEST_CASE_METHOD(NodeSetFixture, "XML that means harm is refused")
{
    const auto error = [&](const std::string& text) {
        return error_of(std::vector<NodeSetSource>{{"t.xml", text}});
    };
    const std::string sound = nodeset_text(object("s=A", below_objects + base_object));
    CHECK(error("<?xml version=\"1.0\"?><!DOCTYPE UANodeSet [<!ENTITY a \"aa\">"
                "<!ENTITY b \"&a;&a;\">]>" +
                sound) == "t.xml: has a DOCTYPE, which a NodeSet2 file must not have");
    CHECK_FALSE(error("<!DOCTYPE UANodeSet SYSTEM \"file:///etc/passwd\">" + sound).empty());
    CHECK_FALSE(error("").empty());
    CHECK_FALSE(error("<UANodeSet>").empty());
    CHECK(error("<html/>") == "t.xml:1: found <html>, expected <UANodeSet>");
    CHECK(error_of(std::vector<NodeSetSource>{{"/nowhere/t.xml"}})
              .starts_with("/nowhere/t.xml: cannot be opened"));
    for (std::size_t size = 0; size < sound.size(); size += 31) {
        CHECK_FALSE(error(sound.substr(0, size)).empty());
    }
    const std::string deep = repeated(100'000, "<a>") + repeated(100'000, "</a>");
    CHECK_FALSE(error_of(variable_text("s=V", "", deep)).empty());
    CHECK_FALSE(error_of(variable_text("s=V", "",
                                       repeated(40, "<ListOfVariant><Variant><Value>") +
                                           "<Int32>1</Int32>" +
                                           repeated(40, "</Value></Variant></ListOfVariant>")))
                    .empty());
    // Each type has the one before twice: 2^20 fields, all of which the value leaves out.
    std::string types = type_text("UADataType", "i=1", "i=22");
    for (int i = 2; i <= 22; ++i) {
        const std::string field = "DataType=\"ns=1;i=" + std::to_string(i - 1) + "\"/>";
        types += type_text("UADataType", "i=" + std::to_string(i), "i=22",
                           "<Definition Name=\"T\"><Field Name=\"A\" " + field +
                               "<Field Name=\"B\" " + field + "</Definition>");
    }
    CHECK(error_of(types + variable_text("s=V", "DataType=\"i=22\"",
                                         "<ExtensionObject><TypeId><Identifier>ns=1;i=22"
                                         "</Identifier></TypeId><Body><T22/></Body>"
                                         "</ExtensionObject>"))
              .ends_with("expected structures of fewer fields in all"));
    NodeSetLimits limits;
    limits.max_kept_xml = 50;
    CHECK_FALSE(
        error_of("<Extensions><e>" + std::string(50, 'x') + "</e></Extensions>", limits).empty());
}

TEST_CASE_METHOD(NodeSetFixture, "Nodes, types and namespaces that were not kept are taken back")
{
    const NodeSetSummary summary = load(type_text("UAObjectType", "i=1", "i=58"));
    CHECK(summary.node_count == 1);
    const std::uint64_t before = detail::space_hash(space);
    const std::size_t count = space.node_count();
    {
        detail::Graft graft{space};
        const std::uint16_t ns = graft.add_namespace("urn:new").value();
        const NodeIndex type =
            graft.create(NodeId{ns, 1U}, QualifiedName{ns, "T"}, NodeClass::ObjectType).value();
        const NodeIndex node =
            graft.create(NodeId{ns, 2U}, QualifiedName{ns, "O"}, NodeClass::Object).value();
        CHECK(graft.create(NodeId{ns, 2U}, QualifiedName{ns, "O"}, NodeClass::Object).error() ==
              status::Bad_NodeIdExists);
        graft.add_reference(find("i=1"), space.find(id::HasSubtype), type);
        graft.add_reference(space.find(id::ObjectsFolder), space.find(id::Organizes), node);
        graft.add_reference(space.find(id::Server), space.find(id::Organizes), node);
        graft.add_reference(node, space.find(id::HasTypeDefinition), type);
        graft.link();
        CHECK(space.is_subtype_of(type, find("i=1")));
        CHECK(space.type_definition(node) == type);
        CHECK(detail::space_hash(space) != before);
    }
    CHECK(detail::space_hash(space) == before);
    CHECK(space.node_count() == count);
    CHECK_FALSE(space.namespace_index("urn:new"));
}

} // namespace busbar::model::nodeset_errors_test
