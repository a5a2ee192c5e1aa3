#include <catch2/catch.hpp>

#include "instance_fixture.hpp"

namespace busbar::model {

TEST_CASE_METHOD(InstanceFixture, "Optional members can be added later")
{
    const NodeIndex type = add_type("OvenType");
    const NodeIndex door =
        declare_object("OvenType.Door", type, optional, NodeId{0, id::BaseObjectType});
    declare_variable("OvenType.Door.IsOpen", door, mandatory);
    declare_variable("OvenType.Light", type, optional);
    const NodeIndex oven = create("Oven", type);
    CHECK(children(oven).empty());
    InstanceOptions options;
    options.optional = {"Door"};
    REQUIRE(add_optional(space, oven, options));
    CHECK(children(oven) == Names{"Door"});
    CHECK(children(find("Oven/Door")) == Names{"IsOpen"});
    // What is there stays as it is.
    options.optional = {"Door", "Light"};
    REQUIRE(add_optional(space, oven, options));
    CHECK(sorted_children(oven) == Names{"Door", "Light"});
    options.optional = {"Window"};
    CHECK(status_of(add_optional(space, oven, options)) == status::Bad_NotFound);
    CHECK(status_of(add_optional(space, type, options)) == status::Bad_TypeDefinitionInvalid);
}

TEST_CASE_METHOD(InstanceFixture, "What fails leaves nothing")
{
    const NodeIndex type = add_type("TankType");
    declare_variable("TankType.Level", type, mandatory);
    const NodeIndex inner =
        declare_object("TankType.Valve", type, mandatory, NodeId{0, id::BaseObjectType});
    const NodeIndex method = space.add_method(declared("TankType.Open", inner)).value();
    set_rule(method, mandatory);
    InstanceOptions options;
    StatusCode expected;
    NodeIndex instance_type = type;
    SECTION("a path that the type does not have")
    {
        options.optional = {"Levl"};
        expected = status::Bad_NotFound;
    }
    SECTION("a NodeId that is taken")
    {
        add_int32("Tank/Valve", objects);
        expected = status::Bad_NodeIdExists;
    }
    SECTION("too many nodes")
    {
        options.limits.max_nodes = 2;
        expected = status::Bad_TooManyOperations;
    }
    SECTION("a type that contains itself")
    {
        declare_object("TankType.Inner", type, mandatory, space.node_id(type));
        expected = status::Bad_TooManyOperations;
    }
    SECTION("a placeholder by name")
    {
        declare_variable("TankType.<X>", type, id::ModellingRule_MandatoryPlaceholder);
        options.optional = {"<X>"};
        expected = status::Bad_NotFound;
    }
    const std::size_t nodes = space.node_count();
    const std::size_t references = reference_count(space);
    CHECK(status_of(instantiate(space, named("Tank", objects), instance_type, options)) ==
          expected);
    CHECK(space.node_count() == nodes);
    CHECK(reference_count(space) == references);
    CHECK(find("Tank") == no_node);
}

TEST_CASE_METHOD(InstanceFixture, "NodeIds are paths or numbers of the instance's namespace")
{
    const NodeIndex type = add_type("Type");
    declare_variable("Type.A", type, mandatory);
    NewNode node = named("Numbered", objects);
    InstanceOptions options;
    options.ids = InstanceIds::Numeric;
    const NodeIndex numbered = instantiate(space, node, type, options).value();
    const NodeId child = space.node_id(find_by_path(space, numbered, "A"));
    CHECK(child.is_numeric());
    CHECK(child.namespace_index() == ns);
    create("Text", type);
    CHECK(space.find(NodeId{ns, "Text/A"}) != no_node);
}

TEST_CASE_METHOD(InstanceFixture, "The instance chooses where a declaration is abstract")
{
    const NodeIndex drive = add_type("DriveType", space.find(id::BaseObjectType), true);
    const NodeIndex servo = add_type("ServoType", drive);
    declare_variable("ServoType.Gain", servo, mandatory);
    const NodeIndex type = add_type("AxisType");
    const NodeIndex part =
        declare_object("AxisType.Drive", type, mandatory, NodeId{0, id::BaseObjectType});
    InstanceOptions options;
    options.types = {{"Drive", space.node_id(servo)}};
    const NodeIndex axis = create("Axis", type, options);
    CHECK(space.type_definition(find("Axis/Drive")) == servo);
    CHECK(find_by_path(space, axis, "Drive/Gain") != no_node);

    const std::size_t before = space.node_count();
    options.types = {{"Drive", space.node_id(drive)}};
    CHECK(status_of(instantiate(space, named("Abstract", objects), type, options)) ==
          status::Bad_TypeDefinitionInvalid);
    REQUIRE(space.remove(part));
    declare_object("AxisType.Drive", type, mandatory, NodeId{0, id::FolderType});
    options.types = {{"Drive", space.node_id(servo)}};
    CHECK(status_of(instantiate(space, named("Other", objects), type, options)) ==
          status::Bad_TypeDefinitionInvalid);
    CHECK(space.node_count() == before);
}

TEST_CASE_METHOD(InstanceFixture, "Every concrete type of namespace 0 has instances",
                 "[unit:Data Access BaseAnalogType]")
{
    std::vector<NodeIndex> types;
    space.for_each([&](NodeIndex node) {
        const NodeClass node_class = space.node_class(node);
        if ((node_class == NodeClass::ObjectType || node_class == NodeClass::VariableType) &&
            !space.is_abstract(node)) {
            types.push_back(node);
        }
    });
    CHECK(types.size() > 150);
    InstanceOptions options;
    options.all_optional = true;
    const std::size_t nodes = space.node_count();
    const std::size_t references = reference_count(space);
    for (const NodeIndex type : types) {
        const std::string name = space.browse_name(type).name.str();
        INFO(name);
        const auto instance = instantiate(space, named("Instance", objects), type, options);
        // Both have a Mandatory member of the abstract NetworkAddressType.
        const bool is_open =
            name == "PubSubConnectionType" || name == "DatagramConnectionTransportType";
        CHECK(status_of(instance) == (is_open ? status::Bad_TypeDefinitionInvalid : status::Good));
        if (instance) {
            REQUIRE(space.remove(*instance));
        }
        REQUIRE(space.node_count() == nodes);
    }
    CHECK(reference_count(space) == references);
}

TEST_CASE_METHOD(InstanceFixture, "Types of namespace 0 have instances too")
{
    InstanceOptions options;
    options.optional = {"EngineeringUnits"};
    NewVariable variable;
    variable.data_type = NodeId{0, id::Double};
    variable.value = Variant{1.5};
    options.variable = variable;
    const NodeIndex analog = space.find(id::AnalogItemType);
    const NodeIndex item = create("Item", analog, options);
    CHECK(sorted_children(item) == Names{"EURange", "EngineeringUnits"});
    CHECK(space.node_id(find_by_path(space, item, "EURange")) == NodeId{ns, "Item/EURange"});
    CHECK(space.type_definition(item) == analog);

    options.variable->data_type = NodeId{0, id::String};
    options.variable->value = {};
    CHECK(status_of(instantiate(space, named("Text", objects), analog, options)) ==
          status::Bad_NodeAttributesInvalid);
}

} // namespace busbar::model
