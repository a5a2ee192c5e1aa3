#include "nodeset_fixture.hpp"

#include <line/nodes.hpp>

#include "support/effort.hpp"

namespace busbar::model::nodeset_load_test {

namespace {

std::string model_text(const std::string& uri, const std::string& attributes,
                       const std::string& required, const std::string& content = {})
{
    return "<UANodeSet><NamespaceUris><Uri>" + uri +
           "</Uri></NamespaceUris><Models>\n<Model "
           "ModelUri=\"" +
           uri + "\" " + attributes + ">\n" + required + "</Model></Models>" + content +
           "</UANodeSet>";
}

std::string required(const std::string& uri, const std::string& attributes)
{
    return "<RequiredModel ModelUri=\"" + uri + "\" " + attributes + "/>";
}

/// Everything of a node that the address space has no place for.
const char* const rich =
    "<UAVariable NodeId=\"ns=1;s=V\" BrowseName=\"1:V\" SymbolicName=\"Vv\" "
    "ReleaseStatus=\"Draft\" "
    "WriteMask=\"5\" AccessRestrictions=\"3\" AccessLevel=\"259\" DataType=\"i=6\" "
    "MinimumSamplingInterval=\"0.1\" Historizing=\"true\">"
    "<DisplayName Locale=\"en\">The V</DisplayName><DisplayName Locale=\"de\">Das V</DisplayName>"
    "<Description> a &lt; b &amp; c </Description><Category>One</Category>"
    "<Documentation>http://d</Documentation>"
    "<References><Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>"
    "<Reference ReferenceType=\"i=40\">i=63</Reference></References>"
    "<RolePermissions><RolePermission Permissions=\"3\">ns=1;i=7</RolePermission>"
    "</RolePermissions>"
    "<Extensions><Extension><x:Tool xmlns:x=\"urn:x\" a=\"1\">text</x:Tool></Extension>"
    "</Extensions></UAVariable>";

/// A type dictionary (Part 5, Annex D) of one file: a Variable of the type system `system` with a
/// description of one type.
std::string dictionary_text(const std::string& id, const std::string& system)
{
    return "<UAVariable NodeId=\"ns=1;s=" + id + "\" BrowseName=\"1:" + id +
           "\" DataType=\"i=15\"><References>"
           "<Reference ReferenceType=\"i=47\" IsForward=\"false\">" +
           system +
           "</Reference><Reference ReferenceType=\"i=40\">i=72</Reference></References>"
           "<Value><ByteString>PGE+PC9hPg==</ByteString></Value></UAVariable>"
           "<UAVariable NodeId=\"ns=1;s=" +
           id +
           ".Point\" BrowseName=\"1:Point\" DataType=\"i=12\"><References>"
           "<Reference ReferenceType=\"i=47\" IsForward=\"false\">ns=1;s=" +
           id +
           "</Reference><Reference ReferenceType=\"i=40\">i=69</Reference></References>"
           "<Value><String>Point</String></Value></UAVariable>";
}

} // namespace

TEST_CASE_METHOD(NodeSetFixture, "A model loaded or linked gives the same address space")
{
    const std::string path = BUSBAR_SOURCE_DIR "/tests/model/line.NodeSet2.xml";
    const NodeSetSummary summary = load(std::vector<NodeSetSource>{{path}});
    AddressSpace linked;
    REQUIRE(linked.add(line::nodes()));
    CHECK(detail::space_hash(space) == detail::space_hash(linked));
    CHECK(linked.access_restrictions(linked.find(NodeId{1, "Belt"})) == 1);
    CHECK(linked.access_restrictions(linked.find(NodeId{1, "Secret"})) == 10);
    check_write_back(space, AddressSpace{}, summary.namespaces, summary);
    // Beside other namespaces, too.
    AddressSpace beside;
    REQUIRE(beside.add_namespace("urn:other"));
    AddressSpace linked_beside;
    REQUIRE(linked_beside.add_namespace("urn:other"));
    REQUIRE(load_nodesets(beside, std::vector{NodeSetSource{path}}));
    REQUIRE(linked_beside.add(line::nodes()));
    CHECK(detail::space_hash(beside) == detail::space_hash(linked_beside));
    CHECK(error_of(std::vector<NodeSetSource>{{path}})
              .ends_with("ns=1;i=1: the address space has a node of this NodeId"));
}

TEST_CASE_METHOD(NodeSetFixture, "Files may come in any order and a file may have more namespaces")
{
    const std::string first = "<UANodeSet><NamespaceUris><Uri>urn:t</Uri></NamespaceUris>" +
                              type_text("UAObjectType", "i=1", "i=58")
                                  .replace(0, 0,
                                           "<Aliases><Alias "
                                           "Alias=\"HasSubtype\">i=45</Alias></Aliases>") +
                              "</UANodeSet>";
    // Numbers the same namespaces the other way round.
    const std::string second =
        "<UANodeSet><NamespaceUris><Uri>urn:b</Uri><Uri>urn:t</Uri></NamespaceUris>"
        "<UAObject NodeId=\"ns=1;s=O\" BrowseName=\"2:O\"><References>"
        "<Reference ReferenceType=\"i=40\">ns=2;i=1</Reference>"
        "<Reference ReferenceType=\"i=47\">ns=2;s=C</Reference></References></UAObject>"
        "<UAObject NodeId=\"ns=2;s=C\" BrowseName=\"1:C\"><References>"
        "<Reference ReferenceType=\"i=40\">i=58</Reference></References></UAObject></UANodeSet>";
    const NodeSetSummary summary = load({{"b.xml", second}, {"a.xml", first}});
    CHECK(summary.node_count == 3);
    CHECK(summary.namespaces == std::vector<std::uint16_t>{1, 2});
    NodeSetFixture other;
    other.load({{"a.xml", first}, {"b.xml", second}});
    CHECK(detail::space_hash(space) == detail::space_hash(other.space));
    const auto b = *space.namespace_index("urn:b");
    const NodeIndex object = space.find(NodeId{b, "O"});
    CHECK(space.type_definition(object) == find("i=1"));
    CHECK(space.browse_name(find("s=C")) == QualifiedName{b, "C"});
    check_write_back(space, AddressSpace{}, summary.namespaces, summary);
}

TEST_CASE_METHOD(NodeSetFixture, "Required models must be there and new enough")
{
    const auto base = [](const std::string& attributes) {
        return NodeSetSource{"base.xml", model_text("urn:base", attributes, "")};
    };
    const auto user = [](const std::string& uri, const std::string& attributes) {
        return NodeSetSource{"user.xml", model_text("urn:user", "", required(uri, attributes))};
    };
    const auto error = [&](const std::string& there, const std::string& needed) {
        return error_of({user("urn:base", needed), base(there)});
    };
    CHECK(error_of({user("urn:none", "Version=\"1\"")}) ==
          "user.xml:3: the model \"urn:user\" requires \"urn:none\" Version 1, found it in no file "
          "and not in the address space");
    CHECK(error("ModelVersion=\"1.9.0\"", "ModelVersion=\"1.10.0\"") ==
          "user.xml:3: the model \"urn:user\" requires \"urn:base\" ModelVersion 1.10.0, found "
          "\"urn:base\" ModelVersion 1.9.0");
    CHECK_FALSE(error("PublicationDate=\"2024-01-01T00:00:00Z\"",
                      "PublicationDate=\"2024-01-02T00:00:00Z\"")
                    .empty());
    // The version of OPC UA itself is in its NamespaceMetadata.
    if (space.find(id::Server_Namespaces) != no_node) {
        CHECK_FALSE(error_of({user("http://opcfoundation.org/UA/",
                                   "PublicationDate=\"2999-01-01T00:00:00Z\"")})
                        .empty());
    }
    load({user("http://opcfoundation.org/UA/", "PublicationDate=\"2020-01-01T00:00:00Z\"")});
    NodeSetFixture newer;
    newer.load({user("urn:base", "ModelVersion=\"1.9.0\" PublicationDate=\"2999-01-01T00:00:00Z\""),
                base("ModelVersion=\"1.10.0\" PublicationDate=\"2024-01-01T00:00:00Z\"")});
}

TEST_CASE_METHOD(NodeSetFixture, "Files with type dictionaries have them below those of OPC UA")
{
    load(dictionary_text("Binary", "i=93") + dictionary_text("Xml", "i=92"));
    const auto is_below = [&](NodeIndex node, NodeIndex parent) {
        ReferenceCursor cursor = space.references(node);
        auto reference = cursor.next();
        while (reference && (reference->is_forward || reference->target != parent)) {
            reference = cursor.next();
        }
        return reference.has_value();
    };
    const auto check = [&](const std::string& dictionary, std::uint32_t system) {
        INFO(dictionary);
        CHECK(is_below(find(dictionary), space.find(system)));
        CHECK(is_below(space.find(system), space.find(id::DataTypesFolder)));
        CHECK(value(dictionary + ".Point") == Variant{"Point"});
    };
    check("ns=1;s=Binary", id::OPCBinarySchema_TypeSystem);
    check("ns=1;s=Xml", id::XmlSchema_TypeSystem);
    CHECK(space.type_definition(find("ns=1;s=Xml")) == space.find(id::DataTypeDictionaryType));
}

TEST_CASE_METHOD(NodeSetFixture, "What the address space has no place for is kept beside it")
{
    const NodeSetSummary summary =
        load({{"t.xml", "<UANodeSet><NamespaceUris><Uri>urn:t</Uri></NamespaceUris>"
                        "<Models><Model ModelUri=\"urn:t\" Version=\"1\" XmlSchemaUri=\"urn:s\">"
                        "<RequiredModel ModelUri=\"http://opcfoundation.org/UA/\"/></Model>"
                        "</Models><Extensions><Extension><t:Info xmlns:t=\"urn:tool\"/></Extension>"
                        "</Extensions>" +
                            std::string{rich} + "</UANodeSet>"}});
    const NodeIndex node = find("s=V");
    CHECK(space.display_name(node) == LocalizedText{"en", "The V"});
    CHECK(space.attribute(node, AttributeId::Description)->value_or(LocalizedText{}).text ==
          " a < b & c ");
    CHECK(space.variable(node).access_level == 3);
    CHECK(space.variable(node).minimum_sampling_interval == 0.1);
    const NodeAccess* const access = space.node_access(node);
    REQUIRE(access != nullptr);
    CHECK(access->role_permissions ==
          Array<RolePermissionType>{{NodeId{1, 7U}, PermissionType{3}}});
    CHECK(space.attribute(node, AttributeId::WriteMask) == Variant{5U});
    CHECK(space.attribute(node, AttributeId::UserWriteMask) == Variant{0U});
    CHECK(space.attribute(node, AttributeId::AccessLevelEx) == Variant{259U});
    CHECK(space.attribute(node, AttributeId::AccessRestrictions) == Variant{std::uint16_t{3}});
    CHECK(space.access_restrictions(node) == 3);
    const NodeSetNodeExtras& extras = summary.extras.nodes.at(NodeId{1, "V"});
    CHECK(extras.attributes ==
          std::vector<NodeSetAttribute>{{"SymbolicName", "Vv"}, {"ReleaseStatus", "Draft"}});
    CHECK(extras.elements.find("<x:Tool xmlns:x=\"urn:x\" a=\"1\">text</x:Tool>") !=
          std::string::npos);
    CHECK(extras.elements.find("Das V") == std::string::npos);
    CHECK(space.texts(node, AttributeId::DisplayName) ==
          std::vector{LocalizedText{"en", "The V"}, LocalizedText{"de", "Das V"}});
    CHECK(summary.extras.file_extensions.count("urn:t") == 1);
    check_write_back(space, AddressSpace{}, {1}, summary);
    CHECK(write_nodeset(space, std::vector<std::uint16_t>{9}).error() == status::Bad_NotFound);
}

TEST_CASE_METHOD(NodeSetFixture, "texts of a file in further locales")
{
    const auto texts = [](const std::string& inner) {
        return std::vector<NodeSetSource>{
            {"t.xml", model_text("urn:t", "", "",
                                 "<UAObject NodeId=\"ns=1;s=O\" BrowseName=\"1:O\">" + inner +
                                     "<References><Reference ReferenceType=\"i=35\" "
                                     "IsForward=\"false\">i=85</Reference><Reference "
                                     "ReferenceType=\"i=40\">i=58</Reference></References>"
                                     "</UAObject>")}};
    };
    const NodeSetSummary summary =
        load(texts("<DisplayName>Oven</DisplayName>"
                   "<DisplayName Locale=\"de\">Ofen</DisplayName>"
                   "<DisplayName Locale=\"de\">Backofen</DisplayName>"
                   "<DisplayName Locale=\"fr\"/>"
                   "<Description Locale=\"en\">Hot</Description>"
                   "<Description Locale=\"de\">Heiss</Description>"
                   "<InverseName>of a reference</InverseName>"
                   "<InverseName Locale=\"de\">einer Referenz</InverseName>"));
    REQUIRE(summary.notes.size() == 2);
    CHECK(text(summary.notes[0]).find("locale 'de'") != std::string::npos);
    CHECK(text(summary.notes[1]).find("does not have") != std::string::npos);
    CHECK(space.texts(find("s=O"), AttributeId::DisplayName) ==
          std::vector{LocalizedText{"Oven"}, LocalizedText{"de", "Ofen"}});
    CHECK(space.texts(find("s=O"), AttributeId::Description) ==
          std::vector{LocalizedText{"en", "Hot"}, LocalizedText{"de", "Heiss"}});
    REQUIRE(space.further_locales().size() == 1);
    CHECK(space.further_locales()[0] == "de");
    check_write_back(space, AddressSpace{}, {1}, summary);

    std::string many;
    for (int i = 0; i < 101; ++i) {
        many += "<DisplayName Locale=\"l" + std::to_string(i) + "\">x</DisplayName>";
    }
    CHECK(NodeSetFixture{}.error_of(texts(many)).find("more than 100") != std::string::npos);
}

TEST_CASE_METHOD(NodeSetFixture, "RolePermissions of a model are for nodes without their own")
{
    load({NodeSetSource{
        "t.xml",
        model_text("urn:t", "",
                   "<RolePermissions><RolePermission Permissions=\"3\">i=15680</RolePermission>"
                   "</RolePermissions>",
                   variable_text("s=A", "", "") +
                       variable_text("s=B", "HasNoPermissions=\"true\"", ""))}});
    const Array<RolePermissionType> operators{
        {NodeId{0, id::WellKnownRole_Operator}, PermissionType{3}}};
    REQUIRE(space.role_permissions(find("s=A")) != nullptr);
    CHECK(*space.role_permissions(find("s=A")) == operators);
    CHECK(space.attribute(find("s=A"), AttributeId::RolePermissions).error() ==
          status::Bad_AttributeIdInvalid);
    REQUIRE(space.role_permissions(find("s=B")) != nullptr);
    CHECK(space.role_permissions(find("s=B"))->empty());
    CHECK(space.role_permissions(space.find(id::ObjectsFolder)) == nullptr);
    CHECK(space.namespace_permissions(1) == operators);
}

TEST_CASE_METHOD(NodeSetFixture, "Restrictions of a model are for nodes without their own")
{
    const auto file = [](const std::string& restrictions) {
        return std::vector<NodeSetSource>{
            {"t.xml", model_text("urn:t", "AccessRestrictions=\"" + restrictions + "\"", "",
                                 variable_text("s=A", "", "") +
                                     variable_text("s=B", "AccessRestrictions=\"0\"", "") +
                                     variable_text("s=C", "HasNoPermissions=\"true\"", ""))}};
    };
    CHECK(error_of(file("70000")).find("AccessRestrictions") != std::string::npos);
    const NodeSetSummary summary = load(file("2"));
    CHECK(space.access_restrictions(find("s=A")) == 2);
    CHECK(space.attribute(find("s=A"), AttributeId::AccessRestrictions).error() ==
          status::Bad_AttributeIdInvalid);
    CHECK(space.access_restrictions(find("s=B")) == 0);
    CHECK(space.attribute(find("s=B"), AttributeId::AccessRestrictions) ==
          Variant{std::uint16_t{0}});
    CHECK(space.access_restrictions(space.find(id::ObjectsFolder)) == 0);
    REQUIRE(space.node_access(find("s=C")) != nullptr);
    CHECK(space.node_access(find("s=C"))->role_permissions == Array<RolePermissionType>(0));
    check_write_back(space, AddressSpace{}, {1}, summary);
    REQUIRE(space.remove(find("s=B")));
    CHECK_FALSE(error_of(std::string{"<UAVariable NodeId=\"ns=1;s=D\" BrowseName=\"D\" "
                                     "AccessRestrictions=\"x\"/>"})
                    .empty());
}

TEST_CASE_METHOD(NodeSetFixture, "A ModellingRule of a file that is removed is nobody's any more")
{
    load("<UAObject NodeId=\"ns=1;i=1\" BrowseName=\"1:Rule\"><References>"
         "<Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>"
         "<Reference ReferenceType=\"i=40\">i=77</Reference></References></UAObject>"
         "<UAObject NodeId=\"ns=1;i=2\" BrowseName=\"1:Ruled\"><References>"
         "<Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference>"
         "<Reference ReferenceType=\"i=37\">ns=1;i=1</Reference>"
         "<Reference ReferenceType=\"i=40\">i=58</Reference></References></UAObject>");
    REQUIRE(space.remove(find("i=1")));
    ReferenceCursor cursor = space.references(find("i=2"));
    while (const auto reference = cursor.next()) {
        CHECK(space.exists(reference->target));
    }
}

TEST_CASE_METHOD(NodeSetFixture, "UTF-16 is read like UTF-8")
{
    const std::string utf8 = nodeset_text(variable_text("s=V", "", "<String>\xC3\xA9</String>"));
    std::string utf16 = "\xFF\xFE";
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        const bool is_accent = utf8[i] == '\xC3';
        utf16 += is_accent ? '\xE9' : utf8[i];
        utf16 += '\0';
        i += is_accent ? 1 : 0;
    }
    load({{"t.xml", utf16}});
    CHECK(value("s=V") == Variant{"\xC3\xA9"});
    CHECK(error_of({{"u.xml", utf16}}).starts_with("u.xml:3: ns=1;s=V: "));
}

TEST_CASE_METHOD(NodeSetFixture, "The limits for large models have room for a million variables")
{
    constexpr std::size_t count = 100;
    constexpr std::size_t factor = 1'000'000 / count;
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string id = "i=" + std::to_string(1'000'000 + i);
        text += variable_text(id, "DataType=\"i=6\"", "<Int32>1</Int32>");
    }
    // As many variables as a part of the limits allows.
    const auto part_of = [](NodeSetLimits limits, std::size_t nodes) {
        limits.max_file_size /= factor;
        limits.max_nodes = nodes;
        limits.max_references /= factor;
        limits.max_value_elements /= factor;
        limits.max_value_fields /= factor;
        limits.max_kept_xml /= factor;
        return limits;
    };
    const std::vector<NodeSetSource> file{{"t.xml", nodeset_text(text)}};
    const NodeSetLimits large = limits_for_large_models();
    CHECK_FALSE(error_of(file, part_of({}, count)).empty());
    CHECK_FALSE(error_of(file, part_of(large, count - 1)).empty());
    CHECK(load(file, part_of(large, large.max_nodes / factor)).node_count == count);
}

TEST_CASE_METHOD(NodeSetFixture, "Long files take no longer than they must")
{
    // One chain, one star and one value of many elements: each a square if a step is not careful.
    const std::size_t count = test::is_full_effort() ? 20'000 : 4'000;
    std::string text;
    for (std::size_t i = 1; i <= count; ++i) {
        const std::string id = std::to_string(i);
        text += "<UAObject NodeId=\"ns=1;i=" + id + "\" BrowseName=\"1:" + id +
                "\"><References><Reference ReferenceType=\"i=40\">i=58</Reference>"
                "<Reference ReferenceType=\"i=47\" IsForward=\"false\">ns=1;i=" +
                std::to_string(i + 1) +
                "</Reference><Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85"
                "</Reference></References></UAObject>";
    }
    text += "<UAObject NodeId=\"ns=1;i=" + std::to_string(count + 1) +
            "\" BrowseName=\"1:Top\"><References><Reference ReferenceType=\"i=40\">i=58</Reference>"
            "</References></UAObject>";
    const NodeSetSummary summary = load(text);
    CHECK(summary.node_count == count + 1);
    check_write_back(space, AddressSpace{}, {1}, summary);
}

} // namespace busbar::model::nodeset_load_test
