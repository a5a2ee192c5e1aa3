#include "nodeset_fixture.hpp"

namespace busbar::model::nodeset_refused_test {

namespace {

std::string object(const std::string& id, const std::string& attributes,
                   const std::string& content = {})
{
    return "<UAObject NodeId=\"ns=1;s=" + id + "\" BrowseName=\"1:" + id + "\" " + attributes +
           "><References><Reference ReferenceType=\"i=40\">i=58</Reference>" + content +
           "</References></UAObject>\n";
}

/// One of the limits, set to `value`.
NodeSetLimits limited(std::size_t NodeSetLimits::*limit, std::size_t value)
{
    NodeSetLimits limits;
    limits.*limit = value;
    return limits;
}

} // namespace

TEST_CASE_METHOD(NodeSetFixture, "Bytes that are not UTF-8 are refused with their line")
{
    const std::string bad = "\xff\xfe";
    const std::string reason = ": found bytes that are not UTF-8 (Part 6, 5.2.2.4); save the file "
                               "as UTF-8 or name its encoding in the first line";
    CHECK(error_of("<UAObject NodeId=\"ns=1;s=A" + bad + "\" BrowseName=\"1:A\"/>") ==
          "t.xml:3" + reason);
    CHECK(error_of("\n<UAObject NodeId=\"ns=1;s=A\" BrowseName=\"1:A\"><DisplayName>\xc3(" +
                   std::string{"</DisplayName></UAObject>"}) == "t.xml:4" + reason);
    // One that says what it is written in.
    load(object("A", "", "") + "<!-- \xc3\xbc -->");
    const std::string latin =
        "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>" + nodeset_text("<!-- \xfc -->");
    load({{"latin.xml", latin}});
}

TEST_CASE_METHOD(NodeSetFixture, "Names of nodes that are none are refused")
{
    const auto error = [&](const std::string& attributes) {
        return error_of("<UAObject " + attributes + "/>");
    };
    CHECK(error("BrowseName=\"1:A\"") == "t.xml:3: found a node without NodeId");
    CHECK(error("NodeId=\" \" BrowseName=\"1:A\"") == "t.xml:3:  : found a node without NodeId");
    CHECK(error("NodeId=\"Nothing\" BrowseName=\"1:A\"") ==
          "t.xml:3: Nothing: found \"Nothing\", expected a NodeId or one of the <Aliases>");
    CHECK(error("NodeId=\"i=x\" BrowseName=\"1:A\"") ==
          "t.xml:3: i=x: found \"i=x\", expected a NodeId such as \"ns=1;i=42\"");
    CHECK(error("NodeId=\"ns=2;i=1\" BrowseName=\"1:A\"") ==
          "t.xml:3: ns=2;i=1: found the namespace index 2, the file lists 1 in <NamespaceUris>");
    CHECK(error("NodeId=\"ns=1;i=1\"") == "t.xml:3: ns=1;i=1: found a node without BrowseName");
    CHECK(error("NodeId=\"ns=1;i=1\" BrowseName=\"7:A\"") ==
          "t.xml:3: ns=1;i=1: found the namespace index 7, the file lists 1 in <NamespaceUris>");
    CHECK(error_of("\n<UAThing NodeId=\"ns=1;i=1\" BrowseName=\"1:A\"/>") ==
          "t.xml:4: found <UAThing>, expected <UAObject>, <UAVariable> or another NodeClass");
}

TEST_CASE_METHOD(NodeSetFixture, "Identifiers and BrowseNames have the sizes that are allowed")
{
    const auto error = [&](const std::string& id, const std::string& name) {
        return error_of("<UAObject NodeId=\"ns=1;" + id + "\" BrowseName=\"1:" + name +
                        "\"><References><Reference ReferenceType=\"i=40\">i=58</Reference>"
                        "</References></UAObject>");
    };
    CHECK(error("s=" + std::string(4097, 'a'), "A")
              .ends_with("found an identifier of 4097 bytes, expected 1 to 4096"));
    // 4,098 bytes in base64.
    std::string opaque = "b=";
    for (int i = 0; i < 1366; ++i) {
        opaque += "AAAA";
    }
    CHECK(error(opaque, "A").ends_with("found an identifier of 4098 bytes, expected 1 to 4096"));
    CHECK(error("s=A", std::string(513, 'n')) ==
          "t.xml:3: ns=1;s=A: found a BrowseName of 513 bytes, expected 1 to 512");
    CHECK(error("s=A", "") ==
          "t.xml:3: ns=1;s=A: found a BrowseName of 0 bytes, expected 1 to 512");
    const std::string id = "s=" + std::string(4096, 'a');
    load("<UAObject NodeId=\"ns=1;" + id + "\" BrowseName=\"1:" + std::string(512, 'n') +
         "\"><References><Reference ReferenceType=\"i=40\">i=58</Reference></References>"
         "</UAObject>");
    CHECK(space.browse_name(find(id)).name.size() == 512);
}

TEST_CASE_METHOD(NodeSetFixture, "Attributes that are no flag and no number are refused")
{
    CHECK(error_of(object("A", "Symmetric=\"yes\"")) ==
          "t.xml:3: ns=1;s=A: found Symmetric=\"yes\", expected true or false");
    CHECK(error_of(variable_text("s=V", "ValueRank=\"1\" ArrayDimensions=\"2,x\"", "")) ==
          "t.xml:3: ns=1;s=V: found ArrayDimensions=\"2,x\", expected numbers separated by commas");
    CHECK(error_of(variable_text("s=V", "ArrayDimensions=\"-1\"", "")) ==
          "t.xml:3: ns=1;s=V: found ArrayDimensions=\"-1\", expected numbers separated by commas");
    CHECK(error_of(object("A", "", "\n<Reference>i=85</Reference>")) ==
          "t.xml:4: ns=1;s=A: found a reference without ReferenceType");
    CHECK(error_of(object("A", "", "<Reference ReferenceType=\"Nope\">i=85</Reference>")) ==
          "t.xml:3: ns=1;s=A: found \"Nope\", expected a NodeId or one of the <Aliases>");
    CHECK(error_of(type_text("UADataType", "i=1", "i=22",
                             "\n<Definition Name=\"T\"><Field DataType=\"i=6\"/></Definition>")) ==
          "t.xml:4: ns=1;i=1: found a field without Name");
}

TEST_CASE_METHOD(NodeSetFixture, "What a file has too much of is refused")
{
    const std::string two = object("A", "") + object("B", "");
    CHECK(error_of(two, limited(&NodeSetLimits::max_nodes, 1)) ==
          "t.xml:4: there are more than 1 nodes");
    // Each node has one.
    CHECK(error_of(two, limited(&NodeSetLimits::max_references, 1)) ==
          "t.xml:4: ns=1;s=B: there are more than 1 references");
    const auto permissions = [](int count) {
        std::string text = "<UAObject NodeId=\"ns=1;i=1\" BrowseName=\"1:A\"><RolePermissions>";
        for (int i = 0; i < count; ++i) {
            text += "<RolePermission Permissions=\"1\">i=15644</RolePermission>";
        }
        return text + "</RolePermissions></UAObject>";
    };
    CHECK(error_of(permissions(3), limited(&NodeSetLimits::max_references, 2)) ==
          "t.xml:3: ns=1;i=1: there are more than 2 references");
    const std::string fields = type_text("UADataType", "i=1", "i=22",
                                         "<Definition Name=\"T\"><Field Name=\"A\"/>\n"
                                         "<Field Name=\"B\"/></Definition>");
    CHECK(error_of(fields, limited(&NodeSetLimits::max_fields, 1)) ==
          "t.xml:4: ns=1;i=1: there are more than 1 fields in a definition");
    const std::string values = variable_text("s=V", "DataType=\"i=6\" ValueRank=\"1\"",
                                             "<ListOfInt32><Int32>1</Int32><Int32>2</Int32>"
                                             "</ListOfInt32>");
    CHECK(error_of(values, limited(&NodeSetLimits::max_value_elements, 1)) ==
          "t.xml:3: ns=1;s=V: there are more than 1 value elements");
    CHECK(error_of(values, limited(&NodeSetLimits::max_value_depth, 1)) ==
          "t.xml:3: ns=1;s=V: a <Value> is more than 1 elements deep");
    CHECK(error_of(two, limited(&NodeSetLimits::max_file_size, 100)) ==
          "t.xml: is larger than 100 bytes");
    const std::string path = BUSBAR_SOURCE_DIR "/tests/model/line.NodeSet2.xml";
    CHECK(
        error_of(std::vector<NodeSetSource>{{path}}, limited(&NodeSetLimits::max_file_size, 100)) ==
        path + ": is larger than 100 bytes");
    CHECK(error_of(std::vector<NodeSetSource>{{BUSBAR_SOURCE_DIR}}) == BUSBAR_SOURCE_DIR
          ": cannot be read: Is a directory");
}

TEST_CASE_METHOD(NodeSetFixture, "Namespaces, aliases and models of a file have limits")
{
    const auto error = [&](const std::string& head, const NodeSetLimits& limits) {
        return error_of(
            std::vector<NodeSetSource>{{"t.xml", "<UANodeSet>" + head + "</UANodeSet>"}}, limits);
    };
    const NodeSetLimits none;
    CHECK(error("<NamespaceUris><Uri>urn:a</Uri>\n<Uri> </Uri></NamespaceUris>", none) ==
          "t.xml:2: found an empty <Uri>");
    CHECK(error("<NamespaceUris>\n<Uri>urn:a</Uri><Uri>urn:b</Uri></NamespaceUris>",
                limited(&NodeSetLimits::max_namespaces, 2)) ==
          "t.xml:2: there are too many namespaces");
    CHECK(error("<Aliases><Alias Alias=\"A\">i=1</Alias>\n<Alias Alias=\"B\">i=2</Alias></Aliases>",
                limited(&NodeSetLimits::max_aliases, 1)) ==
          "t.xml:2: there are more than 1 aliases");
    CHECK(error("<Models><Model ModelUri=\"urn:a\"><RequiredModel ModelUri=\"urn:b\"/></Model>\n"
                "<Model ModelUri=\"urn:c\"><RequiredModel ModelUri=\"urn:d\"/></Model></Models>",
                limited(&NodeSetLimits::max_namespaces, 1)) ==
          "t.xml:1: the model \"urn:a\" requires \"urn:b\", found it in no file and not in the "
          "address space");
    CHECK(error("<Models><Model ModelUri=\"urn:a\"><RequiredModel ModelUri=\"urn:b\"/></Model>\n"
                "<Model ModelUri=\"urn:c\"><RequiredModel ModelUri=\"urn:d\"/>\n"
                "<RequiredModel ModelUri=\"urn:e\"/></Model></Models>",
                limited(&NodeSetLimits::max_namespaces, 2)) ==
          "t.xml:3: there are more than 2 required models");
    // Elements that are not known are left alone.
    const NodeSetSummary summary =
        load({{"t.xml", "<UANodeSet><NamespaceUris><Other/><Uri>urn:a</Uri></NamespaceUris>"
                        "<Aliases><Other/></Aliases><Models><Other/></Models><Later><Things/>"
                        "</Later><!-- no node --></UANodeSet>"}});
    CHECK(summary.node_count == 0);
    CHECK(summary.extras.models.empty());
    CHECK(space.namespace_index("urn:a") == 1);
}

TEST_CASE_METHOD(NodeSetFixture, "No more errors and notes are told than was asked for")
{
    const std::string bad = "<UAObject NodeId=\"ns=1;i=1\"/>\n";
    const std::string noted = object("A", "",
                                     "<Reference ReferenceType=\"i=39\">ns=1;i=8"
                                     "</Reference><Reference ReferenceType=\"i=39\">"
                                     "ns=1;i=9</Reference>");
    const auto limits = limited(&NodeSetLimits::max_errors, 1);
    const std::vector<NodeSetSource> faulty{{"t.xml", nodeset_text(bad + "<UAThing/>" + bad)}};
    const auto loaded = load_nodesets(space, faulty, limits);
    REQUIRE_FALSE(loaded);
    REQUIRE(loaded.error().size() == 1);
    CHECK(text(loaded.error()[0]) == "t.xml:3: ns=1;i=1: found a node without BrowseName");
    // Nor of those that only the whole of the files has.
    const auto planned = load_nodesets(
        space,
        std::vector<NodeSetSource>{{"t.xml", nodeset_text("<UAObject NodeId=\"ns=1;i=1\" "
                                                          "BrowseName=\"1:A\"/>\n"
                                                          "<UAObject NodeId=\"ns=1;i=2\" "
                                                          "BrowseName=\"1:B\"/>")}},
        limits);
    REQUIRE_FALSE(planned);
    REQUIRE(planned.error().size() == 1);
    CHECK(text(planned.error()[0]) ==
          "t.xml:3: ns=1;i=1: found an Object without HasTypeDefinition");
    const NodeSetSummary summary = load({{"t.xml", nodeset_text(noted)}}, limits);
    REQUIRE(summary.notes.size() == 1);
    CHECK(text(summary.notes[0]) == "t.xml:3: ns=1;s=A: found a reference to nsu=urn:t;i=8, which "
                                    "is in no file and not in the address space");
}

TEST_CASE_METHOD(NodeSetFixture, "Types and instances of files fit those that are there")
{
    CHECK(error_of("<UAObjectType NodeId=\"ns=1;i=1\" BrowseName=\"1:T\"><References>"
                   "<Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=58</Reference>\n"
                   "<Reference ReferenceType=\"i=40\">i=58</Reference></References>"
                   "</UAObjectType>") ==
          "t.xml:4: ns=1;i=1: found a HasTypeDefinition reference from an ObjectType");
    // FolderType (i=61) and what is above it.
    CHECK(error_of(type_text("UAObjectType", "i=1", "i=58") +
                   "<UAObjectType NodeId=\"ns=1;i=2\" BrowseName=\"1:U\"><References>"
                   "<Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=58</Reference>"
                   "<Reference ReferenceType=\"HasSubtype\">i=61</Reference></References>"
                   "</UAObjectType>") ==
          "t.xml:4: ns=1;i=2: found a second supertype of i=61, which is in the address space");
    CHECK(error_of(variable_text("s=V", "DataType=\"i=58\"", "")) ==
          "t.xml:3: ns=1;s=V: found the DataType i=58, which is an ObjectType");
    // A reference that names its node's type from the other side.
    CHECK(load("<UAObjectType NodeId=\"ns=1;i=1\" BrowseName=\"1:T\"><References>"
               "<Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=58</Reference>"
               "<Reference ReferenceType=\"i=40\" IsForward=\"false\">ns=1;i=2</Reference>"
               "</References></UAObjectType>"
               "<UAObject NodeId=\"ns=1;i=2\" BrowseName=\"1:O\"/>")
              .node_count == 2);
    CHECK(space.type_definition(find("i=2")) == find("i=1"));
}

TEST_CASE_METHOD(NodeSetFixture, "UTF-16 may have any character, and halves of one")
{
    const bool is_little = GENERATE(true, false);
    // A euro sign, a face, a half without its other one, two first halves, and one at the end.
    const std::u16string value =
        u"\u20AC\U0001F600" + std::u16string{0xDE00, u'x', 0xD83D, 0xD83D, u'y'};
    const std::string text = nodeset_text(variable_text("s=V", "", "<String>?</String>"));
    std::string bytes = is_little ? "\xFF\xFE" : "\xFE\xFF";
    const auto put = [&](char16_t unit) {
        const char low = static_cast<char>(unit & 0xFFU);
        const char high = static_cast<char>(unit >> 8U);
        bytes += is_little ? low : high;
        bytes += is_little ? high : low;
    };
    for (const char c : text) {
        if (c != '?') {
            put(static_cast<unsigned char>(c));
            continue;
        }
        for (const char16_t unit : value) {
            put(unit);
        }
    }
    load({{"t.xml", bytes}});
    CHECK(this->value("s=V") == Variant{"\xE2\x82\xAC\xF0\x9F\x98\x80\xEF\xBF\xBDx\xEF\xBF\xBD"
                                        "\xEF\xBF\xBDy"});
    put(0xD83D); // behind the end of the XML
    bytes += '\0';
    CHECK_FALSE(error_of({{"u.xml", bytes}}).empty());
}

TEST_CASE_METHOD(NodeSetFixture, "Comments and elements that are not known are left alone")
{
    load(
        "<UADataType NodeId=\"ns=1;i=1\" BrowseName=\"1:T\"><!-- a --><References><!-- b "
        "--><Other/>"
        "<Reference ReferenceType=\"HasSubtype\" IsForward=\"false\">i=22</Reference></References>"
        "<Definition Name=\"T\"><!-- c --><Other/><Field Name=\"A\" DataType=\"i=3\"/></Definition>"
        "</UADataType>"
        "<UAVariable NodeId=\"ns=1;s=V\" BrowseName=\"1:V\" DataType=\"i=22\"><References>"
        "<Reference ReferenceType=\"i=40\">i=63</Reference></References><RolePermissions>"
        "<!-- d --><Other/><RolePermission Permissions=\"3\">i=15644</RolePermission>"
        "</RolePermissions><Value><!-- e --><ExtensionObject><!-- f --><TypeId><Identifier>"
        "ns=1;i=1</Identifier></TypeId><Body><T><!-- g --><A>4</A></T></Body></ExtensionObject>"
        "</Value></UAVariable>");
    const NodeAccess* const access = space.node_access(find("s=V"));
    REQUIRE(access != nullptr);
    REQUIRE(access->role_permissions.size() == 1);
    CHECK(static_cast<std::uint32_t>(access->role_permissions[0].permissions) == 3);
    const Variant loaded = value("s=V");
    REQUIRE(loaded.get_if<ExtensionObject>() != nullptr);
    const std::byte body{4};
    CHECK(loaded ==
          Variant{ExtensionObject::from_binary(NodeId{1, 1U}, ByteString{std::span{&body, 1}})});
}

TEST_CASE_METHOD(NodeSetFixture, "Nodes of which there are no instances have no type definition")
{
    const auto error = [&](const std::string& element) {
        return error_of("<" + element +
                        " NodeId=\"ns=1;i=1\" BrowseName=\"1:A\"><References>"
                        "<Reference ReferenceType=\"i=40\">i=58</Reference></References></" +
                        element + ">");
    };
    const std::string text = "t.xml:3: ns=1;i=1: found a HasTypeDefinition reference from a ";
    CHECK(error("UAMethod") == text + "Method");
    CHECK(error("UAView") == text + "View");
    CHECK(error("UADataType") == text + "DataType");
    CHECK(error("UAReferenceType") == text + "ReferenceType");
    CHECK(error("UAVariableType") == text + "VariableType");
    CHECK(error_of(variable_text("s=V", "DataType=\"i=85\"", "")) ==
          "t.xml:3: ns=1;s=V: found the DataType i=85, which is an Object");
    CHECK(error_of(variable_text("s=V", "DataType=\"i=2259\"", "")) ==
          "t.xml:3: ns=1;s=V: found the DataType i=2259, which is a Variable");
}

TEST_CASE_METHOD(NodeSetFixture, "Nodes of namespace 0 that are there are not loaded again")
{
    const NodeSetSummary summary =
        load("<UAObject NodeId=\"i=85\" BrowseName=\"Other\"><References>"
             "<Reference ReferenceType=\"i=35\">ns=1;s=A</Reference></References></UAObject>"
             "<UAObjectType NodeId=\"i=61\" BrowseName=\"Other\"/>" +
             object("A", ""));
    CHECK(summary.node_count == 1);
    CHECK(summary.skipped_count == 2);
    CHECK(summary.namespaces == std::vector<std::uint16_t>{1});
    CHECK(space.browse_name(space.find(id::ObjectsFolder)) == QualifiedName{0, "Objects"});
    CHECK(space.browse_name(space.find(id::FolderType)) == QualifiedName{0, "FolderType"});
}

} // namespace busbar::model::nodeset_refused_test
