#include <catch2/catch.hpp>

#include "model_fixture.hpp"

namespace busbar::model::method_node_test {

namespace {

NewMethod with_inputs(Array<Argument> inputs)
{
    NewMethod method;
    method.input_arguments = std::move(inputs);
    return method;
}

} // namespace

TEST_CASE_METHOD(ModelFixture, "A Method has properties for its arguments",
                 "[unit:Address Space Method]")
{
    const NodeIndex folder = add_folder("folder", objects);
    NewMethod method = with_inputs(
        {{"a", NodeId{0, id::Int32}, -1, {}, {}}, {"b", NodeId{0, id::Double}, 2, {0, 3}, {}}});
    method.executable = false;
    method.source = 3;
    method.handle = 4;
    const std::size_t before = space.node_count();
    const NodeIndex added = space.add_method(named("run", folder), method).value();
    CHECK(space.node_count() == before + 2); // no OutputArguments
    CHECK(children(added) == std::vector<std::string>{"InputArguments"});
    CHECK(space.method(added).source == 3);
    CHECK(space.method(added).handle == 4);
    CHECK_FALSE(space.method(added).executable);

    NodeIndex property = no_node;
    space.for_each_child(added, space.find(id::HasProperty), false,
                         QualifiedName{0, "InputArguments"}, [&](NodeIndex child) {
                             property = child;
                             return false;
                         });
    REQUIRE(property != no_node);
    CHECK(space.node_id(property).namespace_index() == ns);
    CHECK(space.data_type_id(property) == NodeId{0, id::Argument});
    const Variant value = space.value(property);
    REQUIRE(value.array_size() == 2);
    const auto* const second = (*value.array_if<ExtensionObject>())[1].get_if<Argument>();
    REQUIRE(second != nullptr);
    CHECK(*second == method.input_arguments[1]);

    // It is called on its folder, of which it is a component.
    ReferenceCursor cursor = space.references(added);
    const auto parent = cursor.next();
    REQUIRE(parent);
    CHECK(space.node_id(parent->type).is(id::HasComponent));

    REQUIRE(space.remove(added));
    CHECK(space.node_count() == before);
}

TEST_CASE_METHOD(ModelFixture, "A Method whose arguments are none is not added")
{
    const std::size_t before = space.node_count();
    const auto refused = [&](Argument argument) {
        return status_of(
            space.add_method(named("run", objects), with_inputs({std::move(argument)})));
    };
    CHECK(refused({"a", NodeId{ns, "no type"}, -1, {}, {}}) == status::Bad_NodeAttributesInvalid);
    CHECK(refused({"a", NodeId{0, id::Int32}, -4, {}, {}}) == status::Bad_NodeAttributesInvalid);
    CHECK(refused({"a", NodeId{0, id::Int32}, -1, {1}, {}}) == status::Bad_NodeAttributesInvalid);
    CHECK(space.node_count() == before);
}

TEST_CASE_METHOD(ModelFixture, "Executable can be set, and a Method be bound, later")
{
    const NodeIndex method = space.add_method(named("run", objects)).value();
    CHECK(space.method(method).executable);
    CHECK(space.method(method).source == no_source);
    space.set_executable(method, false);
    CHECK(space.attribute(method, AttributeId::Executable).value() == Variant{false});
    space.set_executable(method, true);
    space.bind(method, 5, 6);
    CHECK(space.method(method).source == 5);
    CHECK(space.attribute(method, AttributeId::Executable).value() == Variant{true});
    CHECK(space.method(objects).source == no_source);

    // A constant one, where namespace 0 has it.
    const NodeIndex constant = space.find(id::Server_GetMonitoredItems);
    if (constant != no_node) {
        CHECK(space.method(constant).executable);
        space.bind(constant, 1, 2);
        CHECK(space.method(constant).executable);
        space.set_executable(constant, false);
        CHECK_FALSE(space.method(constant).executable);
        CHECK(space.method(constant).handle == 2);
    }
}

} // namespace busbar::model::method_node_test
