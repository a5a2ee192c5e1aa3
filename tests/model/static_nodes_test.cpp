#include <catch2/catch.hpp>

#include <line/nodes.hpp>

#include "model_fixture.hpp"

namespace busbar::model::static_nodes_test {

namespace {

/// The generated nodes of line.NodeSet2.xml beside another namespace.
struct LineFixture : ModelFixture {
    LineFixture() { REQUIRE(space.add(line::nodes())); }

    std::uint16_t line{space.add_namespace("urn:line").value()};
    [[nodiscard]] NodeIndex at(const char* name) const { return space.find(NodeId{line, name}); }
};

} // namespace

TEST_CASE_METHOD(LineFixture, "Generated nodes of another namespace join the address space")
{
    CHECK(line == 2);
    const NodeIndex press = at("Press");
    REQUIRE(press != no_node);
    CHECK(children(press) == std::vector<std::string>{"State", "Limits"});
    CHECK(space.display_name(press).text == "The press");
    CHECK(space.display_name(at("Belt")).text == "Belt");
    const NodeIndex type = space.type_definition(press);
    CHECK(space.node_id(type) == NodeId{line, 2U});
    CHECK(space.is_subtype_of(type, space.find(NodeId{line, 1U})));
    CHECK(space.is_subtype_of(type, id::BaseObjectType));
    CHECK(space.is_abstract(space.supertype(type)));
    const auto objects_children = children(objects);
    CHECK(std::count(objects_children.begin(), objects_children.end(), "Press") == 1);
}

TEST_CASE_METHOD(LineFixture, "Their values, types and references are whole")
{
    const NodeIndex state = at("Press.State");
    CHECK(space.variable(state).access_level == 3);
    CHECK(space.built_in_type_of(space.variable(state).data_type) == BuiltInType::Int32);
    const auto limits = Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63");
    CHECK(space.value(space.find(NodeId{line, *limits})) == Variant{Array<double>{-1.5, 2}});
    const NodeIndex feeds = space.find(NodeId{line, 3U});
    CHECK(space.attribute(feeds, AttributeId::InverseName).value() ==
          Variant{LocalizedText{"FedBy"}});
    CHECK(space.attribute(space.find(NodeId{line, 4U}), AttributeId::DataTypeDefinition));
    int fed_by = 0;
    ReferenceCursor cursor = space.references(at("Belt"));
    while (const auto reference = cursor.next()) {
        fed_by +=
            reference->type == feeds && !reference->is_forward && reference->target == at("Press")
                ? 1
                : 0;
    }
    CHECK(fed_by == 1);
}

TEST_CASE_METHOD(LineFixture, "They are added once, and removed like any others")
{
    CHECK(status_of(space.add(line::nodes())) == status::Bad_NodeIdExists);
    REQUIRE(space.remove(at("Press")));
    CHECK(at("Press.State") == no_node);
    CHECK(space.references(at("Belt")).next()->target == objects);
}

} // namespace busbar::model::static_nodes_test
