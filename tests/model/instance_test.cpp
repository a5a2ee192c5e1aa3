#include <catch2/catch.hpp>

#include "instance_fixture.hpp"

namespace busbar::model::instance_test {

TEST_CASE_METHOD(InstanceFixture, "An instance has what is Mandatory and what was chosen")
{
    const NodeIndex type = add_type("MotorType");
    declare_variable("MotorType.Speed", type, mandatory, 7);
    declare_variable("MotorType.Torque", type, optional);
    declare_variable("MotorType.<Sensor>", type, id::ModellingRule_OptionalPlaceholder);
    add_int32("NotDeclared", type);

    const NodeIndex plain = create("Plain", type);
    CHECK(children(plain) == Names{"Speed"});
    CHECK(space.type_definition(plain) == type);
    InstanceOptions options;
    SECTION("by path")
    {
        options.optional = {"Torque"};
    }
    SECTION("by predicate")
    {
        options.is_wanted = [](std::string_view path, NodeIndex) { return path == "Torque"; };
    }
    SECTION("all")
    {
        options.all_optional = true;
    }
    CHECK(sorted_children(create("Full", type, options)) == Names{"Speed", "Torque"});
    const NodeIndex speed = find("Full/Speed");
    REQUIRE(speed != no_node);
    CHECK(int_value(speed) == 7);
    CHECK(space.variable(speed).access_level == 3);
    CHECK(space.browse_name(speed) == QualifiedName{ns, "Speed"});
    ReferenceCursor cursor = space.references(speed);
    while (const auto reference = cursor.next()) {
        CHECK_FALSE(space.node_id(reference->type).is(id::HasModellingRule));
    }
}

TEST_CASE_METHOD(InstanceFixture, "A BrowsePath is there once, as the most derived type has it")
{
    const NodeIndex base = add_type("BaseType", space.find(id::BaseObjectType), true);
    declare_variable("BaseType.A", base, optional, 1);
    declare_variable("BaseType.B", base, mandatory, 1);
    const NodeIndex derived = add_type("DerivedType", base);
    declare_variable("DerivedType.A", derived, mandatory, 2);
    const NodeIndex instance = create("Instance", derived);
    CHECK(sorted_children(instance) == Names{"A", "B"});
    CHECK(int_value(find("Instance/A")) == 2);
    CHECK(int_value(find("Instance/B")) == 1);
    CHECK(status_of(instantiate(space, named("Abstract", objects), base)) ==
          status::Bad_TypeDefinitionInvalid);
    CHECK(status_of(instantiate(space, named("NoType", objects), objects)) ==
          status::Bad_TypeDefinitionInvalid);
}

TEST_CASE_METHOD(InstanceFixture,
                 "Members of members come from their types and what overrides them")
{
    const NodeIndex axis = add_type("AxisType");
    declare_variable("AxisType.Position", axis, mandatory, 1);
    declare_variable("AxisType.Load", axis, optional, 1);
    const NodeIndex robot = add_type("RobotType");
    const NodeId axis_id = space.node_id(axis);
    const NodeIndex first = declare_object("RobotType.First", robot, mandatory, axis_id);
    declare_object("RobotType.Second", robot, optional, axis_id);
    declare_variable("RobotType.First.Position", first, mandatory, 5);

    InstanceOptions options;
    options.optional = {"Second/Load"};
    const NodeIndex instance = create("Robot", robot, options);
    CHECK(sorted_children(instance) == Names{"First", "Second"});
    CHECK(children(find("Robot/First")) == Names{"Position"});
    CHECK(int_value(find("Robot/First/Position")) == 5);
    CHECK(sorted_children(find("Robot/Second")) == Names{"Load", "Position"});
    CHECK(int_value(find("Robot/Second/Position")) == 1);
    CHECK(find_by_path(space, instance, "Second/Load") == find("Robot/Second/Load"));
    CHECK(find_by_path(space, instance, "Second/Nothing") == no_node);
}

TEST_CASE_METHOD(InstanceFixture, "A node that two paths lead to is one node of the instance")
{
    const NodeIndex type = add_type("DeviceType");
    const NodeId base{0, id::BaseObjectType};
    const NodeIndex parameters = declare_object("DeviceType.Parameters", type, mandatory, base);
    const NodeIndex group = declare_object("DeviceType.Group", type, mandatory, base);
    const NodeIndex shared = declare_variable("DeviceType.Shared", parameters, mandatory);
    REQUIRE(space.add_reference(group, NodeId{0, id::Organizes}, shared));
    const NodeIndex other = declare_variable("DeviceType.Other", group, mandatory);
    REQUIRE(space.add_reference(other, NodeId{0, id::HasEffect}, shared));

    for (const char* const name : {"One", "Two"}) {
        const NodeIndex instance = create(name, type);
        const NodeIndex node = find_by_path(space, instance, "Parameters/Shared");
        REQUIRE(node != no_node);
        CHECK(node != shared);
        CHECK(find_by_path(space, instance, "Group/Shared") == node);
        // References that are not hierarchical lead to nodes of the same instance.
        CHECK(status_of(space.remove_reference(find_by_path(space, instance, "Group/Other"),
                                               NodeId{0, id::HasEffect}, node)) == status::Good);
    }
}

TEST_CASE_METHOD(InstanceFixture, "Methods are shared or copied")
{
    const NodeIndex type = add_type("DoorType");
    NewMethod method;
    method.source = 3;
    method.handle = 4;
    Argument argument;
    argument.name = "Angle";
    argument.data_type = NodeId{0, id::Double};
    argument.value_rank = -1;
    method.input_arguments = {argument};
    const NodeIndex open = space.add_method(declared("DoorType.Open", type), method).value();
    set_rule(open, mandatory);

    const NodeIndex sharing = create("Sharing", type);
    CHECK(find_by_path(space, sharing, "Open") == open);
    InstanceOptions options;
    options.methods = InstanceMethods::Copied;
    const NodeIndex copy = find_by_path(space, create("Copying", type, options), "Open");
    REQUIRE(copy != no_node);
    CHECK(copy != open);
    CHECK(space.method(copy).source == 3);
    CHECK(space.method(copy).handle == 4);
    const NodeIndex inputs = find_by_path(space, copy, "InputArguments");
    REQUIRE(inputs != no_node);
    CHECK(space.value(inputs).array_size() == 1);
    REQUIRE(space.remove(sharing));
    CHECK(space.exists(open));
}

TEST_CASE_METHOD(InstanceFixture, "An Object has the members of its type's Interfaces",
                 "[unit:Address Space Interfaces]")
{
    const NodeIndex base = space.find(id::BaseInterfaceType);
    const NodeIndex tagged = add_type("ITaggedType", base, true);
    declare_variable("ITaggedType.Tag", tagged, mandatory, 1);
    const NodeIndex placed = add_type("IPlacedType", tagged, true);
    declare_variable("IPlacedType.Place", placed, mandatory);
    declare_variable("IPlacedType.Floor", placed, optional);
    const NodeId has_interface{0, id::HasInterface};

    SECTION("of the type")
    {
        const NodeIndex type = add_type("PumpType");
        declare_variable("PumpType.Tag", type, mandatory, 2);
        REQUIRE(space.add_reference(type, has_interface, placed));
        CHECK(sorted_children(create("Pump", type)) == Names{"Place", "Tag"});
        CHECK(int_value(find("Pump/Tag")) == 2);
    }
    SECTION("of a declaration")
    {
        const NodeIndex type = add_type("LineType");
        const NodeIndex part =
            declare_object("LineType.Part", type, mandatory, NodeId{0, id::BaseObjectType});
        REQUIRE(space.add_reference(part, has_interface, placed));
        create("Line", type);
        CHECK(sorted_children(find("Line/Part")) == Names{"Place", "Tag"});
        CHECK(status_of(space.remove_reference(find("Line/Part"), has_interface, placed)) ==
              status::Good);
    }
    SECTION("added to an Object")
    {
        const NodeIndex object = space.add_object(named("Object", objects), {}).value();
        add_int32("Place", object);
        InstanceOptions options;
        options.optional = {"Floor"};
        REQUIRE(add_interface(space, object, placed, options));
        CHECK(sorted_children(object) == Names{"Floor", "Place", "Tag"});
        CHECK(status_of(add_interface(space, object, space.find(id::FolderType))) ==
              status::Bad_TypeDefinitionInvalid);
    }
}

TEST_CASE_METHOD(InstanceFixture, "An AddIn has the BrowseName that its type says",
                 "[unit:Address Space AddIn DefaultInstanceBrowsename]"
                 "[unit:Address Space AddIn Reference]")
{
    const NodeIndex type = add_type("LockType");
    declare_variable("LockType.Locked", type, mandatory);
    const NodeIndex machine = space.add_object(named("Machine", objects), {}).value();
    CHECK(status_of(add_add_in(space, machine, type)) == status::Bad_BrowseNameInvalid);

    NewNode name = declared("LockType.DefaultInstanceBrowseName", type);
    name.browse_name.namespace_index = 0;
    NewVariable variable;
    variable.data_type = NodeId{0, id::QualifiedName};
    variable.value = Variant{QualifiedName{ns, "Lock"}};
    REQUIRE(space.add_property(name, variable));
    const NodeIndex derived = add_type("SafeLockType", type);
    REQUIRE(add_add_in(space, machine, derived));
    const NodeIndex lock = find("Machine/Lock");
    REQUIRE(lock != no_node);
    CHECK(space.type_definition(lock) == derived);
    CHECK(children(lock) == Names{"Locked"});
    ReferenceCursor cursor = space.references(lock);
    CHECK(space.node_id(cursor.next()->type).is(id::HasAddIn));
    CHECK(status_of(add_add_in(space, machine, derived, NodeId{ns, "Other"})) ==
          status::Bad_BrowseNameDuplicated);
}

} // namespace busbar::model::instance_test
