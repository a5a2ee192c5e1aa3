#include <catch2/catch.hpp>

#include <model/nodeset/document.hpp>

namespace busbar::nodeset::document_test {

namespace {

std::string nodeset(const std::string& content)
{
    return "<UANodeSet>\n<NamespaceUris><Uri>urn:a</Uri></NamespaceUris>\n"
           "<Aliases><Alias Alias=\"Organizes\">i=35</Alias></Aliases>\n" +
           content + "\n</UANodeSet>";
}

/// The first error of a document that contains `content` on its fourth line.
std::string error_of(const std::string& content, const Limits& limits = {})
{
    Document document{limits};
    const auto errors = document.load_text(nodeset(content), "f.xml");
    return errors.empty() ? std::string{} : text(errors.front());
}

std::string object(const std::string& attributes, const std::string& content = "")
{
    return "<UAObject NodeId=\"ns=1;i=1\" BrowseName=\"1:A\" " + attributes + ">" + content +
           "</UAObject>";
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

TEST_CASE("A document has the nodes of its files with one table of namespaces")
{
    Document document;
    REQUIRE(document
                .load_text("<UANodeSet><NamespaceUris><Uri>urn:b</Uri><Uri>urn:a</Uri>"
                           "</NamespaceUris><UAView NodeId=\"ns=2;s=v\" BrowseName=\"1:V\" "
                           "EventNotifier=\"1\" ContainsNoLoops=\"1\"/></UANodeSet>",
                           "b.xml")
                .empty());
    REQUIRE(document
                .load_text(nodeset("<x:UAVariable xmlns:x=\"u\" NodeId=\"ns=1;i=1\" "
                                   "BrowseName=\"1:a:b\" DataType=\"i=6\" ValueRank=\"2\" "
                                   "ArrayDimensions=\"2,3\" AccessLevel=\"3\">"
                                   "<x:DisplayName Locale=\"en\">text</x:DisplayName>"
                                   "<x:References><x:Reference ReferenceType=\"Organizes\" "
                                   "IsForward=\"false\"> i=85 </x:Reference></x:References>"
                                   "<x:Value><u:ListOfInt32 xmlns:u=\"t\"><u:Int32>1</u:Int32>"
                                   "<u:Int32>2</u:Int32></u:ListOfInt32></x:Value>"
                                   "</x:UAVariable>"),
                           "a.xml")
                .empty());
    CHECK(document.namespaces() ==
          std::vector<std::string>{"http://opcfoundation.org/UA/", "urn:b", "urn:a"});
    const Node* const view = document.find(NodeId{2, "v"});
    REQUIRE(view != nullptr);
    CHECK(view->node_class == NodeClass::View);
    CHECK(view->browse_namespace == 1);
    CHECK(view->contains_no_loops);
    const Node* const variable = document.find(NodeId{2, 1U});
    REQUIRE(variable != nullptr);
    CHECK(variable->browse_name == "a:b");
    CHECK(variable->display_name.locale == "en");
    CHECK(variable->array_dimensions == std::vector<std::uint32_t>{2, 3});
    REQUIRE(variable->references.size() == 1);
    CHECK(variable->references[0].target.is(85));
    CHECK_FALSE(variable->references[0].is_forward);
    REQUIRE(variable->value);
    CHECK(variable->value->name == "ListOfInt32");
    CHECK(variable->value->children.at(1).text == "2");
}

TEST_CASE("Errors name file, line, what was found and what was expected")
{
    CHECK(error_of("<UAObjekt/>") ==
          "f.xml:4: found <UAObjekt>, expected <UAObject>, <UAVariable> or another NodeClass");
    CHECK(error_of(object("ParentNodeId=\"x=1\"")) ==
          "f.xml:4: ns=1;i=1: found \"x=1\", expected a NodeId such as \"ns=1;i=42\"");
    CHECK(error_of(object("ParentNodeId=\"HasNothing\"")) ==
          "f.xml:4: ns=1;i=1: found \"HasNothing\", expected a NodeId or one of the <Aliases>");
    CHECK(error_of(object("ParentNodeId=\"ns=2;i=1\"")) ==
          "f.xml:4: ns=1;i=1: found the namespace index 2, the file lists 1 in <NamespaceUris>");
    CHECK(error_of(object("EventNotifier=\"256\"")) ==
          "f.xml:4: ns=1;i=1: found EventNotifier=\"256\", expected a number in the range of the "
          "attribute");
    CHECK(error_of("<UAMethod NodeId=\"i=1\" BrowseName=\"A\" Executable=\"yes\"/>") ==
          "f.xml:4: i=1: found Executable=\"yes\", expected true or false");
    CHECK(error_of(object("") + "\n" + object("")) ==
          "f.xml:5: ns=1;i=1: the node is already at f.xml:4");
    CHECK(error_of("<UAObject BrowseName=\"A\"/>") == "f.xml:4: found a node without NodeId");
    CHECK(error_of("<UAObject NodeId=\"i=1\"/>") ==
          "f.xml:4: i=1: found a node without BrowseName");
    CHECK(error_of(object("", "<References><Reference>i=1</Reference></References>")) ==
          "f.xml:4: ns=1;i=1: found a reference without ReferenceType");

    Document document;
    CHECK(text(document.load_text("<html/>", "f.xml").front()) ==
          "f.xml:1: found <html>, expected <UANodeSet>");
    CHECK(document.load_text("<UANodeSet>\n<a>\n</UANodeSet>", "f.xml").front().where == "f.xml:3");
    CHECK_FALSE(document.load_text("", "f.xml").empty());
    CHECK_FALSE(document.load_file("/nowhere/at/all.xml").empty());
    CHECK_FALSE(document.load_file("/").empty());
}

TEST_CASE("Files are limited in size, count and depth")
{
    Limits limits;
    limits.max_nodes = 1;
    limits.max_references = 2;
    limits.max_value_depth = 3;
    limits.max_value_elements = 5;
    limits.max_errors = 2;
    CHECK(error_of(object("") + "<UAObject NodeId=\"i=2\" BrowseName=\"B\"/>", limits) ==
          "f.xml:4: there are more than 1 nodes");
    const std::string reference = "<Reference ReferenceType=\"i=35\">i=1</Reference>";
    CHECK(error_of(object("", "<References>" + repeated(3, reference) + "</References>"), limits) ==
          "f.xml:4: ns=1;i=1: there are more than 2 references");
    const auto variable = [](const std::string& value) {
        return "<UAVariable NodeId=\"i=3\" BrowseName=\"B\"><Value>" + value +
               "</Value></UAVariable>";
    };
    CHECK(error_of(variable("<a><b><c/></b></a>"), limits).empty());
    CHECK(error_of(variable("<a><b><c><d/></c></b></a>"), limits) ==
          "f.xml:4: i=3: a <Value> is more than 3 elements deep");
    CHECK(error_of(variable("<a>" + repeated(6, "<b/>") + "</a>"), limits) ==
          "f.xml:4: i=3: there are more than 5 value elements");

    Document document{limits};
    CHECK(document.load_text(nodeset(repeated(9, "<UANothing/>")), "f.xml").size() == 2);
    limits.max_file_size = 100;
    Document small{limits};
    CHECK(text(small.load_text(std::string(101, ' '), "f.xml").front()) ==
          "f.xml: is larger than 100 bytes");
    CHECK(small.load_file(BUSBAR_SOURCE_DIR "/schemas/Opc.Ua.Types.NodeSet2.xml").size() == 1);
}

TEST_CASE("Deep and broken XML does no harm")
{
    constexpr std::size_t levels = 200'000;
    Document document;
    static_cast<void>(document.load_text(
        nodeset(repeated(levels, "<Extensions>") + repeated(levels, "</Extensions>")), "f.xml"));
    CHECK_FALSE(document.load_text(repeated(levels, "<a>"), "f.xml").empty());

    const std::string text =
        nodeset(object("EventNotifier=\"1\"", "<References>" + std::string{} +
                                                  "<Reference ReferenceType=\"Organizes\">"
                                                  "ns=1;i=2</Reference></References>"));
    for (std::size_t size = 0; size < text.size(); ++size) {
        Document part;
        static_cast<void>(part.load_text(text.substr(0, size), "f.xml"));
        std::string damaged = text;
        damaged[size] = static_cast<char>(damaged[size] ^ 0x15);
        static_cast<void>(part.load_text(damaged, "f.xml"));
    }
}

} // namespace busbar::nodeset::document_test
