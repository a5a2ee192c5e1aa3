#include <catch2/catch.hpp>

#include <busbar/model/instance.hpp>

#include "management_fixture.hpp"

namespace add_nodes_test {

using namespace busbar;
using namespace busbar::test;

TEST_CASE_METHOD(ManagementFixture, "AddNodes adds nodes with the attributes that are specified",
                 "[unit:Node Management Add Node]")
{
    VariableAttributes attributes;
    attributes.specified_attributes = mask(
        {NodeAttributesMask::DisplayName, NodeAttributesMask::Value, NodeAttributesMask::DataType,
         NodeAttributesMask::ValueRank, NodeAttributesMask::AccessLevel});
    attributes.display_name = LocalizedText{"en", "New"};
    attributes.description = LocalizedText{"en", "not specified"};
    attributes.value = std::int32_t{7};
    attributes.data_type = NodeId{0, id::Int32};
    attributes.value_rank = -1;
    attributes.access_level = 3;
    attributes.historizing = true; // not specified
    const AddNodesResult result = add(variable_item(attributes));
    REQUIRE(result.status_code == status::Good);
    const NodeId added = result.added_node_id;
    CHECK(added == NodeId{1, "new"});
    CHECK(attribute(added, AttributeId::DisplayName) == Variant{attributes.display_name});
    CHECK(attribute(added, AttributeId::Description) == Variant{});
    CHECK(attribute(added, AttributeId::AccessLevel) == Variant{std::uint8_t{3}});
    CHECK(attribute(added, AttributeId::Historizing) == Variant{false});
    CHECK(server.address_space().value(server.address_space().find(added)) ==
          Variant{std::int32_t{7}});
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes takes GenericAttributes and defaults of the type")
{
    GenericAttributes attributes;
    attributes.attribute_values = {
        {static_cast<std::uint32_t>(AttributeId::DataType), NodeId{0, id::Double}},
        {static_cast<std::uint32_t>(AttributeId::ValueRank), std::int32_t{1}},
        {static_cast<std::uint32_t>(AttributeId::ArrayDimensions), Array<std::uint32_t>{3}}};
    AddNodesItem made = generic_item(attributes);
    made.requested_new_node_id = {};
    const AddNodesResult result = add(made);
    REQUIRE(result.status_code == status::Good);
    // The server's own namespace, whatever the BrowseName's is.
    CHECK(result.added_node_id.namespace_index() == 1);
    CHECK(attribute(result.added_node_id, AttributeId::DataType) == Variant{NodeId{0, id::Double}});
    CHECK(attribute(result.added_node_id, AttributeId::ArrayDimensions) ==
          Variant{Array<std::uint32_t>{3}});
    made = variable_item();
    made.node_attributes = {};
    REQUIRE(status_of_adding(made) == status::Bad_BrowseNameDuplicated);
    made.browse_name = QualifiedName{1, "plain"};
    REQUIRE(status_of_adding(made) == status::Good);
    CHECK(attribute(NodeId{1, "new"}, AttributeId::DataType) ==
          Variant{NodeId{0, id::BaseDataType}});
    CHECK(attribute(NodeId{1, "new"}, AttributeId::ValueRank) == Variant{std::int32_t{-2}});
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes adds nodes of every NodeClass")
{
    struct Case {
        NodeClass node_class;
        std::uint32_t parent;
        std::uint32_t reference;
        ExtensionObject attributes;
    };
    const Case cases[] = {
        {NodeClass::Method, id::ObjectsFolder, id::HasComponent,
         ExtensionObject::from(MethodAttributes{})},
        {NodeClass::ObjectType, id::BaseObjectType, id::HasSubtype,
         ExtensionObject::from(ObjectTypeAttributes{})},
        {NodeClass::VariableType, id::BaseDataVariableType, id::HasSubtype,
         ExtensionObject::from(VariableTypeAttributes{})},
        {NodeClass::ReferenceType, id::Organizes, id::HasSubtype,
         ExtensionObject::from(ReferenceTypeAttributes{})},
        {NodeClass::DataType, id::Structure, id::HasSubtype,
         ExtensionObject::from(DataTypeAttributes{})},
        {NodeClass::View, id::ViewsFolder, id::Organizes, ExtensionObject::from(ViewAttributes{})},
    };
    for (const Case& each : cases) {
        AddNodesItem made = item(std::to_string(static_cast<int>(each.node_class)).c_str());
        made.parent_node_id = NodeId{0, each.parent};
        made.reference_type_id = NodeId{0, each.reference};
        made.node_class = each.node_class;
        made.type_definition = {};
        made.node_attributes = each.attributes;
        const AddNodesResult result = add(made);
        CHECK(result.status_code == status::Good);
        CHECK(attribute(result.added_node_id, AttributeId::NodeClass) == Variant{each.node_class});
    }
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes says what is wrong with place and name of a node")
{
    AddNodesItem made = item();
    SECTION("parents")
    {
        for (const ExpandedNodeId& parent :
             {ExpandedNodeId{}, ExpandedNodeId{NodeId{1, "none"}}, ExpandedNodeId{rights.hidden},
              ExpandedNodeId{folder, {}, 1}, ExpandedNodeId{folder, "urn:x"}}) {
            made.parent_node_id = parent;
            CHECK(status_of_adding(made) == status::Bad_ParentNodeIdInvalid);
        }
        made.parent_node_id = rights.kept;
        CHECK(status_of_adding(made) == status::Bad_UserAccessDenied);
    }
    SECTION("references")
    {
        for (const NodeId& type :
             {NodeId{}, NodeId{1, "none"}, folder, NodeId{0, id::HierarchicalReferences}}) {
            made.reference_type_id = type;
            CHECK(status_of_adding(made) == status::Bad_ReferenceTypeIdInvalid);
        }
        for (const std::uint32_t type : {id::HasSubtype, id::HasProperty, id::GeneratesEvent}) {
            made.reference_type_id = NodeId{0, type};
            CHECK(status_of_adding(made) == status::Bad_ReferenceNotAllowed);
        }
    }
    SECTION("NodeIds")
    {
        for (const ExpandedNodeId& id :
             {ExpandedNodeId{NodeId{0, 99'999U}}, ExpandedNodeId{NodeId{9, 1U}},
              ExpandedNodeId{NodeId{1, ""}}, ExpandedNodeId{NodeId{1, "new"}, {}, 1},
              ExpandedNodeId{NodeId{1, "new"}, "urn:x"}}) {
            made.requested_new_node_id = id;
            CHECK(status_of_adding(made) == status::Bad_NodeIdRejected);
        }
        made.requested_new_node_id = folder;
        CHECK(status_of_adding(made) == status::Bad_NodeIdExists);
    }
    SECTION("BrowseNames")
    {
        for (const QualifiedName& name :
             {QualifiedName{}, QualifiedName{1, ""}, QualifiedName{9, "x"},
              QualifiedName{1, String{std::string(513, 'x')}}, QualifiedName{1, "a\n"},
              QualifiedName{1, " a"}, QualifiedName{1, "\xe2\x80\xaetxt.exe"}}) {
            made.browse_name = name;
            CHECK(status_of_adding(made) == status::Bad_BrowseNameInvalid);
        }
        CHECK(status_of_adding(item()) == status::Good);
        made = item("other");
        made.browse_name = QualifiedName{1, "new"};
        CHECK(status_of_adding(made) == status::Bad_BrowseNameDuplicated);
    }
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes says what is wrong with class, type and attributes")
{
    AddNodesItem made = item();
    for (const int node_class : {0, 3, 256, -1}) {
        made.node_class = NodeClass{node_class};
        CHECK(status_of_adding(made) == status::Bad_NodeClassInvalid);
    }
    made = item();
    for (const ExpandedNodeId& type :
         {ExpandedNodeId{}, ExpandedNodeId{NodeId{1, "none"}}, ExpandedNodeId{folder},
          ExpandedNodeId{NodeId{0, id::BaseDataVariableType}},
          ExpandedNodeId{NodeId{0, id::BaseEventType}}}) {
        made.type_definition = type;
        CHECK(status_of_adding(made) == status::Bad_TypeDefinitionInvalid);
    }
    made = item();
    made.node_class = NodeClass::View;
    CHECK(status_of_adding(made) == status::Bad_TypeDefinitionInvalid);

    made = item();
    made.node_attributes = ExtensionObject::from(VariableAttributes{});
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
    made.node_attributes = ExtensionObject::from_binary(NodeId{0, 1U}, ByteString{});
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
    ObjectAttributes object;
    object.specified_attributes = mask({NodeAttributesMask::EventNotifier});
    object.event_notifier = 4; // HistoryRead
    made.node_attributes = ExtensionObject::from(object);
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
    ViewAttributes view;
    view.specified_attributes = mask({NodeAttributesMask::EventNotifier});
    view.event_notifier = 1;
    made.node_class = NodeClass::View;
    made.type_definition = {};
    made.node_attributes = ExtensionObject::from(view);
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes checks the attributes of Variables")
{
    const auto refused = [&](NodeAttributesMask bit, auto change) {
        VariableAttributes attributes;
        attributes.specified_attributes =
            mask({bit, NodeAttributesMask::DataType, NodeAttributesMask::ValueRank});
        attributes.data_type = NodeId{0, id::Int32};
        attributes.value_rank = -1;
        change(attributes);
        return status_of_adding(variable_item(attributes)) == status::Bad_NodeAttributesInvalid;
    };
    using Mask = NodeAttributesMask;
    CHECK(refused(Mask::Value, [](auto& a) { a.value = "text"; }));
    CHECK(refused(Mask::DataType, [](auto& a) { a.data_type = folder; }));
    CHECK(refused(Mask::ValueRank, [](auto& a) { a.value_rank = -4; }));
    CHECK(refused(Mask::ArrayDimensions, [](auto& a) { a.array_dimensions = {1, 2}; }));
    CHECK(refused(Mask::Historizing, [](auto& a) { a.historizing = true; }));
    CHECK(refused(Mask::WriteMask, [](auto& a) { a.write_mask = 1; }));
    CHECK(refused(Mask::AccessLevel, [](auto& a) { a.access_level = 8; }));

    const auto refuses = [&](Array<GenericAttributeValue> values) {
        GenericAttributes attributes;
        attributes.attribute_values = std::move(values);
        return status_of_adding(generic_item(attributes)) == status::Bad_NodeAttributesInvalid;
    };
    const auto rank = static_cast<std::uint32_t>(AttributeId::ValueRank);
    CHECK(refuses({{rank, std::int32_t{-1}}, {rank, std::int32_t{-1}}}));
    CHECK(refuses({{rank, std::uint32_t{1}}}));
    CHECK(refuses({{static_cast<std::uint32_t>(AttributeId::DisplayName), LocalizedText{"x"}}}));
    CHECK(refuses({{static_cast<std::uint32_t>(AttributeId::IsAbstract), true}}));
    CHECK(refuses({{static_cast<std::uint32_t>(AttributeId::RolePermissions), Variant{}}}));
    CHECK(refuses({{32, true}}));
    CHECK(refuses({{0xFFFF'FFFF, true}}));
}

TEST_CASE_METHOD(ManagementFixture, "A large node counts for its size")
{
    VariableAttributes attributes;
    attributes.specified_attributes = mask({NodeAttributesMask::Value});
    attributes.value = ByteString{std::vector<std::byte>(3U << 20U)};
    CHECK(status_of_adding(variable_item(attributes)) == status::Bad_OutOfMemory);
}

namespace {

/// An ObjectType "Machine" with a Mandatory Variable "Speed", which has a Mandatory property
/// "Unit", an Optional one "Name" and a Mandatory Method "Stop".
struct MachineFixture : ManagementFixture {
    explicit MachineFixture(std::size_t max_nodes = 100) : ManagementFixture{true, max_nodes}
    {
        auto& space = server.address_space();
        REQUIRE(space.add_object_type(named("Machine", NodeId{0, id::BaseObjectType})));
        model::NewVariable variable;
        variable.value = String{"declared"};
        variable.data_type = NodeId{0, id::String};
        REQUIRE(space.add_variable(named("Speed", NodeId{1, "Machine"}), variable));
        REQUIRE(space.add_property(named("Unit", NodeId{1, "Speed"}), variable));
        REQUIRE(space.add_property(named("Name", NodeId{1, "Machine"}), variable));
        REQUIRE(space.add_method(named("Stop", NodeId{1, "Machine"})));
        rule("Speed", id::ModellingRule_Mandatory);
        rule("Unit", id::ModellingRule_Mandatory);
        rule("Name", id::ModellingRule_Optional);
        rule("Stop", id::ModellingRule_Mandatory);
    }
    void rule(const char* node, std::uint32_t which)
    {
        auto& space = server.address_space();
        REQUIRE(space.add_reference(space.find(NodeId{1, node}), NodeId{0, id::HasModellingRule},
                                    space.find(which)));
    }
    [[nodiscard]] static AddNodesItem machine(const char* name = "new")
    {
        AddNodesItem made = item(name);
        made.type_definition = NodeId{1, "Machine"};
        return made;
    }
    [[nodiscard]] model::NodeIndex member(const char* node, const char* path)
    {
        auto& space = server.address_space();
        return model::find_by_path(space, space.find(NodeId{1, node}), path);
    }
};

/// Room for two instances of three nodes and two more nodes.
struct SmallMachineFixture : MachineFixture {
    SmallMachineFixture() : MachineFixture{8} {}
};

} // namespace

TEST_CASE_METHOD(MachineFixture, "AddNodes adds the Mandatory members of the type too")
{
    auto& space = server.address_space();
    const std::size_t before = space.node_count();
    REQUIRE(status_of_adding(machine()) == status::Good);
    CHECK(space.node_count() == before + 3);
    const model::NodeIndex speed = member("new", "Speed");
    REQUIRE(speed != model::no_node);
    CHECK(space.value(speed) == Variant{String{"declared"}});
    CHECK(space.node_id(speed).namespace_index() == 1);
    CHECK(member("new", "Speed/Unit") != model::no_node);
    CHECK(member("new", "Name") == model::no_node);
    CHECK(member("new", "Stop") == space.find(NodeId{1, "Stop"}));

    REQUIRE(remove(NodeId{1, "new"}) == status::Good);
    CHECK(space.node_count() == before);
    CHECK_FALSE(space.exists(speed));
}

TEST_CASE_METHOD(MachineFixture, "A Variable comes with the members of its VariableType")
{
    AddNodesItem made = variable_item();
    made.reference_type_id = NodeId{0, id::HasComponent};
    made.type_definition = NodeId{0, id::AnalogItemType};
    VariableAttributes attributes;
    attributes.specified_attributes =
        mask({NodeAttributesMask::DataType, NodeAttributesMask::ValueRank});
    attributes.data_type = NodeId{0, id::Double};
    attributes.value_rank = -1;
    made.node_attributes = ExtensionObject::from(attributes);
    REQUIRE(status_of_adding(made) == status::Good);
    CHECK(member("new", "EURange") != model::no_node);
    CHECK(attribute(NodeId{1, "new"}, AttributeId::DataType) == Variant{NodeId{0, id::Double}});

    // A DataType that the type does not allow.
    made.browse_name = QualifiedName{1, "text"};
    made.requested_new_node_id = NodeId{1, "text"};
    attributes.data_type = NodeId{0, id::String};
    made.node_attributes = ExtensionObject::from(attributes);
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
}

TEST_CASE_METHOD(SmallMachineFixture, "Members count as nodes of clients")
{
    auto& space = server.address_space();
    REQUIRE(status_of_adding(machine("a")) == status::Good);
    REQUIRE(status_of_adding(machine("b")) == status::Good);
    const std::size_t before = space.node_count();
    CHECK(status_of_adding(machine("c")) == status::Bad_OutOfMemory);
    CHECK(space.node_count() == before);
    CHECK(space.find(NodeId{1, "c"}) == model::no_node);
    REQUIRE(status_of_adding(item("d")) == status::Good);
    REQUIRE(status_of_adding(item("e")) == status::Good);
    CHECK(status_of_adding(item("f")) == status::Bad_OutOfMemory);
    REQUIRE(remove(NodeId{1, "a"}) == status::Good);
    CHECK(status_of_adding(machine("c")) == status::Good);
}

TEST_CASE_METHOD(MachineFixture, "What fails half way leaves the space as it was")
{
    auto& space = server.address_space();
    SECTION("values that are copied too often")
    {
        const Variant large{ByteString{std::vector<std::byte>(600'000)}};
        for (const char* name : {"x", "y", "z", "w"}) {
            model::NewVariable variable;
            variable.value = large;
            REQUIRE(space.add_variable(named(name, NodeId{1, "Machine"}), variable));
            rule(name, id::ModellingRule_Mandatory);
        }
        const std::size_t before = space.node_count();
        CHECK(status_of_adding(machine()) == status::Bad_OutOfMemory);
        CHECK(space.node_count() == before);
    }
    SECTION("a type without end")
    {
        REQUIRE(space.add_object(named("Part", NodeId{1, "Machine"}), {NodeId{1, "Machine"}, 0}));
        rule("Part", id::ModellingRule_Mandatory);
        const std::size_t before = space.node_count();
        CHECK(status_of_adding(machine()) == status::Bad_OutOfMemory);
        CHECK(space.node_count() == before);
    }
    CHECK(space.find(NodeId{1, "new"}) == model::no_node);
    // The Method that instances would share leads to none of them.
    model::ReferenceCursor cursor = space.references(space.find(NodeId{1, "Stop"}));
    std::size_t parents = 0;
    while (const auto reference = cursor.next()) {
        if (!reference->is_forward && space.is_subtype_of(reference->type, id::HasComponent)) {
            ++parents;
        }
    }
    CHECK(parents == 1);
}

} // namespace add_nodes_test
