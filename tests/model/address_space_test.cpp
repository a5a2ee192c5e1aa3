#include <catch2/catch.hpp>

#include "model_fixture.hpp"

namespace busbar::model::address_space_test {

using Names = std::vector<std::string>;

TEST_CASE_METHOD(ModelFixture, "Nodes are found by every kind of NodeId")
{
    const Guid guid{1, 2, 3, {4}};
    const std::byte bytes[] = {std::byte{1}, std::byte{0}};
    const std::vector<NodeId> ids = {NodeId{ns, 77U}, NodeId{ns, "text"}, NodeId{ns, guid},
                                     NodeId{ns, ByteString{std::span{bytes}}}};
    for (const NodeId& node_id : ids) {
        NewNode node = named(to_string(node_id), objects);
        node.id = node_id;
        const auto added = space.add_folder(node);
        REQUIRE(added);
        CHECK(space.find(node_id) == *added);
        CHECK(space.node_id(*added) == node_id);
        CHECK(space.browse_name(*added) == node.browse_name);
        CHECK(space.display_name(*added).text == node.browse_name.name);
    }
    CHECK(space.find(NodeId{ns, 78U}) == no_node);
    CHECK(space.find(NodeId{0, "text"}) == no_node);
    CHECK(space.find(NodeId{ns, String::borrow("text")}) != no_node);
}

TEST_CASE_METHOD(ModelFixture, "A null NodeId asks for a free number")
{
    NewNode node = named("a", objects);
    node.id = NodeId{};
    const NodeIndex first = space.add_folder(node).value();
    node.browse_name = QualifiedName{ns, "b"};
    const NodeIndex second = space.add_folder(node).value();
    CHECK(space.node_id(first) != space.node_id(second));
    CHECK(space.node_id(first).namespace_index() == ns);
}

TEST_CASE_METHOD(ModelFixture, "New nodes are refused with the status codes of AddNodes")
{
    const NodeIndex folder = add_folder("folder", objects);
    add_int32("a", folder);
    NewNode node = named("b", folder);
    StatusCode expected;
    SECTION("taken NodeId")
    {
        node.id = NodeId{ns, "a"};
        expected = status::Bad_NodeIdExists;
    }
    SECTION("taken NodeId of a constant node")
    {
        node.id = NodeId{0, id::ObjectsFolder};
        expected = status::Bad_NodeIdExists;
    }
    SECTION("unknown namespace")
    {
        node.id = NodeId{99, "b"};
        expected = status::Bad_NodeIdInvalid;
    }
    SECTION("empty identifier")
    {
        node.id = NodeId{ns, ""};
        expected = status::Bad_NodeIdInvalid;
    }
    SECTION("no parent")
    {
        node.parent = no_node;
        expected = status::Bad_ParentNodeIdInvalid;
    }
    SECTION("taken BrowseName")
    {
        node.browse_name = QualifiedName{ns, "a"};
        expected = status::Bad_BrowseNameDuplicated;
    }
    SECTION("empty BrowseName")
    {
        node.browse_name = {};
        expected = status::Bad_BrowseNameInvalid;
    }
    SECTION("no such ReferenceType")
    {
        node.reference_type = NodeId{0, id::ObjectsFolder};
        expected = status::Bad_ReferenceTypeIdInvalid;
    }
    SECTION("abstract ReferenceType")
    {
        node.reference_type = NodeId{0, id::HierarchicalReferences};
        expected = status::Bad_ReferenceTypeIdInvalid;
    }
    SECTION("ReferenceType that is not hierarchical")
    {
        node.reference_type = NodeId{0, id::HasTypeDefinition};
        expected = status::Bad_ReferenceNotAllowed;
    }
    SECTION("HasSubtype to a Variable")
    {
        node.reference_type = NodeId{0, id::HasSubtype};
        expected = status::Bad_ReferenceNotAllowed;
    }
    const std::size_t before = space.node_count();
    CHECK(status_of(space.add_variable(node, {})) == expected);
    CHECK(space.node_count() == before);
    CHECK(children(folder) == Names{"a"});
}

TEST_CASE_METHOD(ModelFixture,
                 "New Variables are refused with attributes that contradict each other")
{
    const NodeIndex folder = add_folder("folder", objects);
    NewVariable variable;
    StatusCode expected;
    SECTION("type definition of another class")
    {
        variable.type_definition = NodeId{0, id::FolderType};
        expected = status::Bad_TypeDefinitionInvalid;
    }
    SECTION("abstract type definition")
    {
        variable.type_definition = NodeId{0, id::BaseVariableType};
        expected = status::Bad_TypeDefinitionInvalid;
    }
    SECTION("DataType that is none")
    {
        variable.data_type = NodeId{0, id::FolderType};
        expected = status::Bad_NodeAttributesInvalid;
    }
    SECTION("ArrayDimensions of a scalar")
    {
        variable.array_dimensions = {3U};
        expected = status::Bad_NodeAttributesInvalid;
    }
    SECTION("value of another type")
    {
        variable.data_type = NodeId{0, id::Int32};
        variable.value = Variant{1.5};
        expected = status::Bad_TypeMismatch;
    }
    const std::size_t before = space.node_count();
    CHECK(status_of(space.add_variable(named("b", folder), variable)) == expected);
    CHECK(space.node_count() == before);
    CHECK(children(folder).empty());
}

TEST_CASE_METHOD(ModelFixture, "A BrowseName that a constant node has below the parent is taken")
{
    NewNode node = named("x", objects);
    node.browse_name = QualifiedName{0, "Server"};
    CHECK(status_of(space.add_folder(node)) == status::Bad_BrowseNameDuplicated);
}

TEST_CASE_METHOD(ModelFixture, "References lead both ways")
{
    const NodeIndex folder = add_folder("folder", objects);
    const NodeIndex variable = add_int32("variable", folder);
    ReferenceCursor cursor = space.references(variable);
    const auto parent = cursor.next();
    REQUIRE(parent);
    CHECK_FALSE(parent->is_forward);
    CHECK(parent->target == folder);
    CHECK(parent->type == space.find(id::Organizes));
    const auto type = cursor.next();
    REQUIRE(type);
    CHECK(type->type == space.find(id::HasTypeDefinition));
    CHECK(type->target == space.find(id::BaseDataVariableType));
    CHECK_FALSE(cursor.next());
    CHECK(space.type_definition(variable) == space.find(id::BaseDataVariableType));
    CHECK(children(folder) == Names{"variable"});
}

TEST_CASE_METHOD(ModelFixture, "References can be added and removed")
{
    const NodeIndex a = add_folder("a", objects);
    const NodeIndex b = add_folder("b", objects);
    const NodeIndex variable = add_int32("variable", a);
    const NodeId organizes{0, id::Organizes};
    REQUIRE(space.add_reference(b, organizes, variable));
    CHECK(status_of(space.add_reference(b, organizes, variable)) ==
          status::Bad_DuplicateReferenceNotAllowed);
    CHECK(children(b) == Names{"variable"});
    CHECK(status_of(space.add_reference(b, organizes, b)) == status::Bad_ReferenceNotAllowed);
    CHECK(status_of(space.add_reference(b, NodeId{0, id::HasTypeDefinition}, a)) ==
          status::Bad_ReferenceNotAllowed);
    CHECK(status_of(space.add_reference(b, NodeId{0, id::References}, a)) ==
          status::Bad_ReferenceTypeIdInvalid);
    CHECK(status_of(space.remove_reference(a, organizes, variable)) == status::Bad_NotFound);
    REQUIRE(space.remove_reference(b, organizes, variable));
    CHECK(children(b).empty());
    CHECK(children(a) == Names{"variable"});
}

// With a look at all others for each of them this takes minutes.
TEST_CASE_METHOD(ModelFixture, "A node takes very many references, and none of them twice")
{
    const NodeIndex folder = add_folder("folder", objects);
    const NodeIndex hub = add_folder("hub", objects);
    const NodeId organizes{0, id::Organizes};
    std::vector<NodeIndex> nodes;
    for (std::size_t i = 0; i < 50'000; ++i) {
        nodes.push_back(add_folder(std::to_string(i), folder));
        REQUIRE(space.add_reference(hub, organizes, nodes.back()));
        REQUIRE(space.add_reference(nodes.back(), organizes, hub));
    }
    for (const NodeIndex node : {nodes.front(), nodes[nodes.size() / 2], nodes.back()}) {
        for (const auto& [source, target] : {std::pair{folder, node}, {hub, node}, {node, hub}}) {
            CHECK(status_of(space.add_reference(source, organizes, target)) ==
                  status::Bad_DuplicateReferenceNotAllowed);
        }
    }
}

// With a search of the whole list for each of them this takes minutes.
TEST_CASE_METHOD(ModelFixture, "Very many references are removed in any order")
{
    constexpr std::size_t count = 60'000;
    const NodeIndex folder = add_folder("folder", objects);
    const NodeIndex hub = add_folder("hub", objects);
    const NodeId organizes{0, id::Organizes};
    std::vector<NodeIndex> nodes;
    for (std::size_t i = 0; i < count; ++i) {
        nodes.push_back(add_folder(std::to_string(i), folder));
        REQUIRE(space.add_reference(hub, organizes, nodes.back()));
    }
    std::vector<NodeIndex> kept;
    // From the end, from the middle, and with additions in between, which close holes.
    for (std::size_t i = 0; i < count; ++i) {
        const NodeIndex node = nodes[i % 2 == 0 ? count - 1 - i / 2 : i / 2];
        REQUIRE(space.remove_reference(hub, organizes, node));
        if (i % 1'000 == 0) {
            kept.push_back(node);
            REQUIRE(space.add_reference(hub, organizes, node));
        }
    }
    CHECK(children(hub).size() == kept.size());
    CHECK(children(folder).size() == count);
    for (const NodeIndex node : kept) {
        REQUIRE(space.remove_reference(hub, organizes, node));
        CHECK(status_of(space.remove_reference(hub, organizes, node)) == status::Bad_NotFound);
    }
    CHECK(children(hub).empty());
}

TEST_CASE_METHOD(ModelFixture, "A removed node takes its children and references along")
{
    const NodeIndex folder = add_folder("folder", objects);
    const NodeIndex other = add_folder("other", objects);
    const NodeIndex inner = add_folder("inner", folder);
    const NodeIndex variable = add_int32("variable", inner);
    REQUIRE(space.add_reference(other, NodeId{0, id::Organizes}, variable));
    const NodeHandle handle = space.handle(variable);
    const std::size_t before = space.node_count();

    REQUIRE(space.remove(folder));
    CHECK(space.node_count() == before - 3);
    CHECK(find("variable") == no_node);
    CHECK(children(other).empty());
    CHECK(space.resolve(handle) == no_node);
    CHECK(status_of(space.remove(folder)) == status::Bad_NodeIdUnknown);
    CHECK(status_of(space.remove(objects)) == status::Bad_NoDeleteRights);

    add_int32("variable", other);
    CHECK(space.resolve(handle) == no_node);
    CHECK(children(other) == Names{"variable"});
}

TEST_CASE_METHOD(ModelFixture, "Nodes can come and go for ever")
{
    const NodeIndex folder = add_folder("folder", objects);
    const std::size_t before = space.node_count();
    for (int round = 0; round < 20; ++round) {
        for (int i = 0; i < 500; ++i) {
            add_int32("v" + std::to_string(i), folder);
        }
        for (int i = 0; i < 500; i += 1 + round % 2) {
            REQUIRE(space.remove(find("v" + std::to_string(i))));
        }
        for (int i = 1; round % 2 != 0 && i < 500; i += 2) {
            REQUIRE(space.remove(find("v" + std::to_string(i))));
        }
    }
    CHECK(space.node_count() == before);
    CHECK(children(folder).empty());
    // Removed nodes leave room for new ones.
    CHECK(space.references(folder).at_most() < 1'500);
}

TEST_CASE_METHOD(ModelFixture, "Children are found by name, whoever is their parent")
{
    const NodeIndex a = add_folder("a", objects);
    const NodeIndex b = add_folder("b", objects);
    const NodeIndex variable = add_int32("variable", a);
    REQUIRE(space.add_reference(b, NodeId{0, id::Organizes}, variable));
    const auto found = [&](NodeIndex parent, std::uint32_t type, bool with_subtypes,
                           const QualifiedName& name) {
        std::vector<NodeIndex> targets;
        space.for_each_child(parent, space.find(type), with_subtypes, name, [&](NodeIndex child) {
            targets.push_back(child);
            return true;
        });
        return targets;
    };
    const QualifiedName name{ns, "variable"};
    for (const NodeIndex parent : {a, b}) {
        CHECK(found(parent, id::HierarchicalReferences, true, name) ==
              std::vector<NodeIndex>{variable});
        CHECK(found(parent, id::HierarchicalReferences, false, name).empty());
        CHECK(found(parent, id::HasComponent, true, name).empty());
        CHECK(found(parent, id::Organizes, false, name).size() == 1);
        CHECK(found(parent, id::Organizes, false, QualifiedName{0, "variable"}).empty());
    }
    CHECK(found(objects, id::Organizes, false, QualifiedName{0, "Server"}).size() == 1);
}

TEST_CASE_METHOD(ModelFixture, "A Variable has the attributes that it was added with")
{
    NewVariable variable;
    variable.data_type = NodeId{0, id::Double};
    variable.value_rank = 2;
    variable.array_dimensions = {2U, 0U};
    variable.access_level = Access::ReadWrite;
    variable.user_access_level = Access::Read;
    variable.minimum_sampling_interval = 20;
    variable.historizing = true;
    variable.source = 4;
    variable.handle = 1ULL << 40U;
    NewNode node = named("v", objects);
    node.display_name = LocalizedText{"en", "Speed"};
    node.description = LocalizedText{"in rpm"};
    const NodeIndex v = space.add_variable(node, variable).value();

    const VariableAttributes attributes = space.variable(v);
    CHECK(attributes.source == 4);
    CHECK(attributes.handle == 1ULL << 40U);
    CHECK(attributes.data_type == space.find(id::Double));
    const auto read = [&](AttributeId attribute) { return space.attribute(v, attribute).value(); };
    CHECK(read(AttributeId::NodeClass) == Variant{2});
    CHECK(read(AttributeId::DisplayName) == Variant{LocalizedText{"en", "Speed"}});
    CHECK(read(AttributeId::Description) == Variant{LocalizedText{"in rpm"}});
    CHECK(read(AttributeId::DataType) == Variant{NodeId{0, id::Double}});
    CHECK(read(AttributeId::ValueRank) == Variant{2});
    CHECK(read(AttributeId::ArrayDimensions) == Variant{Array<std::uint32_t>{2, 0}});
    CHECK(read(AttributeId::AccessLevel) == Variant{std::uint8_t{3}});
    CHECK(read(AttributeId::UserAccessLevel) == Variant{std::uint8_t{1}});
    CHECK(read(AttributeId::AccessLevelEx) == Variant{3U});
    CHECK(read(AttributeId::MinimumSamplingInterval) == Variant{20.0});
    CHECK(read(AttributeId::Historizing) == Variant{true});
    CHECK(read(AttributeId::WriteMask) == Variant{0U});
    for (const AttributeId absent :
         {AttributeId::Executable, AttributeId::IsAbstract, AttributeId::RolePermissions,
          AttributeId::AccessRestrictions, AttributeId::DataTypeDefinition, AttributeId{0},
          AttributeId{28}, AttributeId{UINT32_MAX}}) {
        CHECK(status_of(space.attribute(v, absent)) == status::Bad_AttributeIdInvalid);
    }
}

TEST_CASE_METHOD(ModelFixture, "Values that no source serves lie in the address space")
{
    NewVariable variable;
    variable.data_type = NodeId{0, id::String};
    variable.value = Variant{"mm"};
    const NodeIndex property = space.add_property(named("Unit", objects), variable).value();
    CHECK(space.value(property) == Variant{"mm"});
    CHECK(space.type_definition(property) == space.find(id::PropertyType));
    REQUIRE(space.set_value(property, Variant{"inch"}));
    CHECK(space.value(property) == Variant{"inch"});
    CHECK(status_of(space.set_value(property, Variant{1})) == status::Bad_TypeMismatch);
}

TEST_CASE_METHOD(ModelFixture, "Constant Variables can be given values and sources")
{
    const NodeIndex array = space.find(id::Server_NamespaceArray);
    REQUIRE(array != no_node);
    const Variant uris{Array<String>{"http://opcfoundation.org/UA/", "urn:test"}};
    REQUIRE(space.set_value(array, uris));
    CHECK(space.value(array) == uris);
    CHECK(space.variable(array).source == no_source);
    space.bind(array, 2, 5);
    CHECK(space.variable(array).source == 2);
    CHECK(space.variable(array).handle == 5);
    space.set_access_level(array, Access::ReadWrite, Access::Write);
    CHECK(space.variable(array).user_access_level == 2);
    space.set_description(array, LocalizedText{"all of them"});
    CHECK(space.attribute(array, AttributeId::Description).has_value());
    // Another AddressSpace knows nothing of that.
    CHECK(AddressSpace{}.variable(array).source == no_source);
}

TEST_CASE_METHOD(ModelFixture, "Namespaces are added once")
{
    CHECK(space.namespace_uri(0) == "http://opcfoundation.org/UA/");
    CHECK(space.add_namespace("urn:test").value() == ns);
    CHECK(space.namespace_index("urn:test") == ns);
    CHECK_FALSE(space.namespace_index("urn:other"));
    CHECK(space.namespace_uri(99).empty());
}

TEST_CASE_METHOD(ModelFixture, "A hundred thousand Variables are all there")
{
    constexpr int count = 100'000;
    const NodeIndex folder = add_folder("folder", objects);
    space.reserve(count);
    NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    for (int i = 0; i < count; ++i) {
        variable.handle = static_cast<std::uint64_t>(i);
        REQUIRE(space.add_variable(named("Line.V" + std::to_string(i), folder), variable));
    }
    for (int i = 0; i < count; ++i) {
        const NodeIndex node = find("Line.V" + std::to_string(i));
        REQUIRE(node != no_node);
        REQUIRE(space.variable(node).handle == static_cast<std::uint64_t>(i));
    }
    CHECK(find("Line.V100000") == no_node);
}

TEST_CASE_METHOD(ModelFixture, "Nodes are found together as one by one")
{
    const NodeIndex folder = add_folder("folder", objects);
    NewVariable variable;
    variable.data_type = NodeId{0, id::Int32};
    std::vector<NodeId> ids;
    for (unsigned i = 0; i < 1'000; ++i) {
        NewNode node = named("V" + std::to_string(i), folder);
        if (i % 3 == 0) {
            node.id = NodeId{ns, i + 1};
        }
        ids.push_back(node.id);
        REQUIRE(space.add_variable(node, variable));
        ids.push_back(NodeId{ns, "none " + std::to_string(i)});
        ids.push_back(NodeId{0, i});
    }
    // Where a node is removed others are not where their search begins.
    for (std::size_t i = 0; i < ids.size(); i += 30) {
        REQUIRE(space.remove(space.find(ids[i])));
    }
    std::vector<const NodeId*> sought;
    std::vector<NodeIndex> one_by_one;
    for (const NodeId& each : ids) {
        sought.push_back(&each);
        one_by_one.push_back(space.find(each));
    }
    std::vector<NodeIndex> together(sought.size());
    space.find_nodes(sought, together);
    CHECK(together == one_by_one);
    // By handles too; what has gone since, and what never was, are nothing.
    std::vector<NodeHandle> handles;
    for (std::size_t i = 0; i < one_by_one.size(); ++i) {
        handles.push_back(one_by_one[i] != no_node ? space.handle(one_by_one[i]) : NodeHandle{});
        if (one_by_one[i] != no_node && !space.is_constant(one_by_one[i]) && i % 7 == 0) {
            REQUIRE(space.remove(one_by_one[i]));
            one_by_one[i] = no_node;
        }
    }
    handles.push_back({NodeIndex{1'000'000}, 1});
    one_by_one.push_back(no_node);
    together.resize(handles.size());
    space.resolve_nodes(handles, together);
    CHECK(together == one_by_one);
}

} // namespace busbar::model::address_space_test
