#include <catch2/catch.hpp>

#include "instance_fixture.hpp"

namespace busbar::model::instance_choice_test {

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

TEST_CASE_METHOD(InstanceFixture, "Little memory anywhere leaves nothing")
{
    const NodeIndex interface_type = add_type("IPart", space.find(id::BaseInterfaceType));
    declare_variable("IPart.Maker", interface_type, mandatory);
    const NodeIndex type = add_type("PressType");
    REQUIRE(space.add_reference(type, NodeId{0, id::HasInterface}, interface_type));
    const NodeIndex first = declare_variable("PressType.Force", type, mandatory);
    const NodeIndex second =
        declare_object("PressType.Ram", type, mandatory, NodeId{0, id::BaseObjectType});
    REQUIRE(space.add_reference(second, NodeId{0, id::HasEffect}, first));
    NewMethod method;
    Argument argument;
    argument.name = "Stroke";
    argument.data_type = NodeId{0, id::Int32};
    argument.value_rank = -1;
    method.input_arguments = {argument};
    set_rule(space.add_method(declared("PressType.Press", type), method).value(), mandatory);
    InstanceOptions options;
    options.methods = InstanceMethods::Copied;
    const std::size_t nodes = space.node_count();
    const std::size_t references = reference_count(space);
    std::size_t refused = 0;
    for (options.limits.max_memory = 0;; options.limits.max_memory += 16) {
        const auto made = instantiate(space, named("Press", objects), type, options);
        if (made) {
            break;
        }
        ++refused;
        REQUIRE(made.error() == status::Bad_TooManyOperations);
        REQUIRE(space.node_count() == nodes);
        REQUIRE(reference_count(space) == references);
    }
    CHECK(refused > 40);
    CHECK(sorted_children(find("Press")) == Names{"Force", "Maker", "Press", "Ram"});
    CHECK(children(find("Press/Press")) == Names{"InputArguments"});
}

TEST_CASE_METHOD(InstanceFixture, "Members have the texts and rights of their declarations")
{
    const NodeIndex type = add_type("PumpType");
    NewNode node = declared("PumpType.Motor", type);
    node.display_name = LocalizedText{"en", "Motor"};
    node.description = LocalizedText{"en", "Turns"};
    const NodeIndex motor =
        space.add_object(node, {NodeId{0, id::BaseObjectType}, std::uint8_t{1}}).value();
    set_rule(motor, mandatory);
    REQUIRE(
        space.set_text(motor, AttributeId::DisplayName, Variant{LocalizedText{"de", "Antrieb"}}));
    REQUIRE(space.set_text(motor, AttributeId::Description, Variant{LocalizedText{"de", "Dreht"}}));
    NodeAccess access;
    access.write_mask = 5;
    access.restrictions = std::uint16_t{3};
    space.set_node_access(motor, access);
    create("Pump", type);
    const NodeIndex made = find("Pump/Motor");
    REQUIRE(made != no_node);
    CHECK(space.texts(made, AttributeId::DisplayName) ==
          std::vector<LocalizedText>{{"en", "Motor"}, {"de", "Antrieb"}});
    CHECK(space.texts(made, AttributeId::Description) ==
          std::vector<LocalizedText>{{"en", "Turns"}, {"de", "Dreht"}});
    REQUIRE(space.node_access(made) != nullptr);
    CHECK(space.node_access(made)->write_mask == 5);
    CHECK(space.node_access(made)->restrictions == 3);
    CHECK(space.attribute(made, AttributeId::EventNotifier).value() == Variant{std::uint8_t{1}});
    // Further texts count as memory.
    CHECK(memory_of(space, made) > memory_of(space, create("Bare", add_type("BareType"))));
}

TEST_CASE_METHOD(InstanceFixture, "An instance of a VariableType is as narrow as that or narrower")
{
    int count = 0;
    const auto status_with = [&](std::int32_t type_rank, std::int32_t rank,
                                 std::uint32_t data_type = id::Int32) {
        NewVariableType declared_type;
        declared_type.data_type = NodeId{0, id::Number};
        declared_type.value_rank = type_rank;
        const NewNode node =
            named("VT" + std::to_string(++count), space.find(id::BaseDataVariableType));
        const NodeIndex type = space.add_variable_type(node, declared_type).value();
        InstanceOptions options;
        NewVariable& variable = options.variable.emplace();
        variable.data_type = NodeId{0, data_type};
        variable.value_rank = rank;
        const auto made = instantiate(space, named("V", objects), type, options);
        const StatusCode status = status_of(made);
        CHECK((find("V") != no_node) == made.has_value());
        if (made) {
            REQUIRE(space.remove(*made));
        }
        return status;
    };
    const StatusCode refused = status::Bad_NodeAttributesInvalid;
    CHECK(status_with(-2, 3) == status::Good);
    CHECK(status_with(-3, -1) == status::Good);
    CHECK(status_with(-3, 1) == status::Good);
    CHECK(status_with(-3, -3) == status::Good);
    CHECK(status_with(-3, 2) == refused);
    CHECK(status_with(-3, -2) == refused);
    CHECK(status_with(0, 0) == status::Good);
    CHECK(status_with(0, 2) == status::Good);
    CHECK(status_with(0, -1) == refused);
    CHECK(status_with(1, 1) == status::Good);
    CHECK(status_with(1, 2) == refused);
    CHECK(status_with(-1, -1, id::Number) == status::Good);
    CHECK(status_with(-1, -1, id::String) == refused);
    CHECK(status_with(-1, -1, id::BaseDataType) == refused);
}

TEST_CASE_METHOD(InstanceFixture, "An instance needs a parent and a type that can have one")
{
    const NodeIndex type = add_type("Type");
    const NodeIndex abstract = add_type("AbstractType", space.find(id::BaseObjectType), true);
    const auto made = [&](NodeIndex parent, NodeIndex of) {
        return status_of(instantiate(space, named("X", parent), of));
    };
    CHECK(made(no_node, type) == status::Bad_ParentNodeIdInvalid);
    CHECK(made(objects, no_node) == status::Bad_TypeDefinitionInvalid);
    CHECK(made(objects, abstract) == status::Bad_TypeDefinitionInvalid);
    CHECK(made(objects, objects) == status::Bad_TypeDefinitionInvalid);
    CHECK(made(objects, space.find(id::Int32)) == status::Bad_TypeDefinitionInvalid);
    CHECK(status_of(add_add_in(space, no_node, type)) == status::Bad_ParentNodeIdInvalid);
    CHECK(status_of(add_add_in(space, objects, no_node)) == status::Bad_TypeDefinitionInvalid);
    CHECK(status_of(add_add_in(space, objects, type)) == status::Bad_BrowseNameInvalid);
    const NodeIndex object = create("Object", type);
    CHECK(status_of(add_interface(space, no_node, type)) == status::Bad_TypeDefinitionInvalid);
    CHECK(status_of(add_interface(space, object, no_node)) == status::Bad_TypeDefinitionInvalid);
    CHECK(status_of(add_interface(space, object, type)) == status::Bad_TypeDefinitionInvalid);
    CHECK(status_of(add_optional(space, no_node, {})) == status::Bad_TypeDefinitionInvalid);
    CHECK(find("X") == no_node);
    CHECK(children(object).empty());
}

TEST_CASE_METHOD(InstanceFixture, "An Interface that an Object has already is added once")
{
    const NodeIndex interface_type = add_type("IPart", space.find(id::BaseInterfaceType), true);
    declare_variable("IPart.Maker", interface_type, mandatory);
    declare_variable("IPart.Year", interface_type, optional);
    const NodeIndex object = create("Object", add_type("Type"));
    REQUIRE(add_interface(space, object, interface_type));
    CHECK(children(object) == Names{"Maker"});
    const std::size_t references = reference_count(space);
    REQUIRE(add_interface(space, object, interface_type));
    CHECK(reference_count(space) == references);
    // With what is chosen now.
    InstanceOptions options;
    options.optional = {"Year"};
    REQUIRE(add_interface(space, object, interface_type, options));
    CHECK(children(object) == Names{"Maker", "Year"});
    options.optional = {"Month"};
    CHECK(status_of(add_interface(space, object, interface_type, options)) == status::Bad_NotFound);
    CHECK(children(object) == Names{"Maker", "Year"});
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

} // namespace busbar::model::instance_choice_test
