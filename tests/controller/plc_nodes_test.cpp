#include <catch2/catch.hpp>

#include <busbar/controller/plc_nodes.hpp>

namespace plc_nodes_test {

using namespace busbar;
using namespace busbar::controller;

TEST_CASE("a PLC's variables become nodes with their types, shapes and rights")
{
    PlcConfig config;
    PlcVariable speed;
    speed.name = "Speed";
    speed.type = BuiltInType::Int16;
    PlcVariable grid;
    grid.name = "Grid";
    grid.type = BuiltInType::Double;
    grid.dimensions = {2, 3};
    grid.is_writable = false;
    config.variables = {speed, grid};
    const auto plc = std::move(Plc::create(config).value());

    model::AddressSpace space;
    PlcNodesOptions options;
    options.source = 4;
    const auto folder = publish_variables(space, *plc, options);
    REQUIRE(folder);
    const auto index = space.namespace_index("urn:busbar:plc");
    REQUIRE(index);
    CHECK(space.find(NodeId{*index, "PLC"}) == *folder);

    const auto speed_node = space.find(NodeId{*index, "Speed"});
    REQUIRE(speed_node != model::no_node);
    CHECK(space.browse_name(speed_node) == QualifiedName{*index, "Speed"});
    const auto speed_attributes = space.variable(speed_node);
    CHECK(space.data_type_id(speed_node) == NodeId{0, 4U});
    CHECK(speed_attributes.value_rank == -1);
    CHECK(speed_attributes.access_level == 3);
    CHECK(speed_attributes.minimum_sampling_interval == 20);
    CHECK(speed_attributes.source == 4);
    CHECK(speed_attributes.handle == plc->find("Speed"));

    const auto grid_node = space.find(NodeId{*index, "Grid"});
    REQUIRE(grid_node != model::no_node);
    const auto grid_attributes = space.variable(grid_node);
    CHECK(space.data_type_id(grid_node) == NodeId{0, 11U});
    CHECK(grid_attributes.value_rank == 2);
    CHECK(std::vector<std::uint32_t>(grid_attributes.array_dimensions.begin(),
                                     grid_attributes.array_dimensions.end()) == grid.dimensions);
    CHECK(grid_attributes.access_level == 1);
    CHECK(grid_attributes.handle == 1);

    CHECK(publish_variables(space, *plc, options).error() == status::Bad_NodeIdExists);
}

} // namespace plc_nodes_test
