#include <catch2/catch.hpp>

#include <busbar/types/ids.hpp>

#include "machine_parts.hpp"

namespace machine_nodes_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

TEST_CASE("The controller's name is a folder with its state and variables (6-2-1)")
{
    const Machine machine{machine_program()};
    const model::SpaceReader& space = machine.space;
    const std::uint16_t ns = machine.nodes.namespace_index();
    const model::NodeIndex folder =
        model::find_by_path(space, space.find(id::ObjectsFolder), "NJ_1");
    REQUIRE(folder != model::no_node);
    CHECK(space.handle(folder) == machine.nodes.folder());
    CHECK(space.browse_name(folder) == QualifiedName{ns, "NJ_1"});
    CHECK(space.type_definition(folder) == space.find(id::FolderType));
    const model::NodeIndex state = model::find_by_path(space, folder, "DeviceState");
    REQUIRE(state != model::no_node);
    CHECK(space.handle(state) == machine.nodes.device_state());
    for (const char* name : {"ErrorState", "Mode", "UnpublishedVariablesStatus",
                             "NumberOfPublishedVariables", "NumberOfValueAttributes"}) {
        INFO(name);
        const model::NodeIndex property = model::find_by_path(space, state, name);
        REQUIRE(property != model::no_node);
        CHECK(space.type_definition(property) == space.find(id::PropertyType));
        CHECK(space.variable(property).access_level == 1);
    }
    CHECK(model::find_by_path(space, folder, "GlobalVars/Speed") == machine.find("Speed"));
}

TEST_CASE("Variables have the attributes that the table says (6-2-2)")
{
    const Machine machine{machine_program()};
    const model::SpaceReader& space = machine.space;
    const std::uint16_t ns = machine.nodes.namespace_index();
    const auto& published = machine.published.publication.published();
    for (std::size_t handle = 0; handle < published.size(); ++handle) {
        const std::string& name = published[handle].variable->name;
        INFO(name);
        const model::NodeIndex node = machine.find(name);
        REQUIRE(node != model::no_node);
        CHECK(space.browse_name(node) == QualifiedName{ns, String{name}});
        CHECK(space.display_name(node) == LocalizedText{String{name}});
        CHECK(space.variable(node).handle == handle);
        CHECK(space.variable(node).source == 4);
        CHECK(space.variable(node).minimum_sampling_interval == 20);
        CHECK(space.variable(node).access_level == (name == "Limit" ? 1 : 3));
    }
    const auto shape = [&](const char* name) {
        const auto attributes = space.variable(machine.find(name));
        return std::pair{attributes.value_rank,
                         std::vector<std::uint32_t>(attributes.array_dimensions.begin(),
                                                    attributes.array_dimensions.end())};
    };
    CHECK(shape("Speed") == std::pair{-1, std::vector<std::uint32_t>{}});
    CHECK(shape("Points") == std::pair{1, std::vector<std::uint32_t>{4}});
    CHECK(shape("Grid") == std::pair{2, std::vector<std::uint32_t>{2, 3}});
    CHECK(space.data_type_id(machine.find("Speed")) == NodeId{0, id::Int16});
    CHECK(space.data_type_id(machine.find("Limit")) == NodeId{0, id::UInt16});
    CHECK(space.data_type_id(machine.find("State")) == NodeId{0, id::Int32});
    CHECK(space.data_type_id(machine.find("Axis1")) == NodeId{ns, "Types/Axis"});
    CHECK(space.data_type_id(machine.find("Points")) == NodeId{ns, "Types/Point"});
}

TEST_CASE("Mode and error state are set as texts (6-2-1)")
{
    Machine machine{machine_program()};
    CHECK(machine.state("Mode") == Variant{"PROGRAM"});
    CHECK(machine.state("ErrorState") == Variant{"NoError"});
    machine.nodes.set_mode(machine.space, OperatingMode::Run);
    CHECK(machine.state("Mode") == Variant{"RUN"});
    machine.nodes.set_error_state(machine.space, ErrorState::MajorFault);
    CHECK(machine.state("ErrorState") == Variant{"MajorFault"});
    machine.nodes.set_error_state(machine.space, ErrorState::ContinuousError);
    CHECK(machine.state("ErrorState") == Variant{"ContinuousError"});
}

TEST_CASE("Numbers and bits tell what is published (6-2-1)")
{
    Program program = machine_program();
    program.variables.push_back(variable("Odd", array_of(use(ElementaryType::Int), {{1, 2}})));
    const Machine machine{program};
    CHECK(machine.find("Odd") == model::no_node);
    CHECK(machine.state("UnpublishedVariablesStatus") == Variant{std::uint16_t{8}});
    CHECK(machine.state("NumberOfPublishedVariables") == Variant{std::uint32_t{6}});
    // Speed, Limit, State: 1 each; Points 8, Grid 6; Axis1 2 + 4 + 1 + 3 + 1.
    CHECK(machine.state("NumberOfValueAttributes") == Variant{std::uint32_t{28}});
}

TEST_CASE("Variables that are added online join the others (6-2-2, online editing)")
{
    Machine machine{machine_program()};
    Program edit = machine.published.program;
    edit.types.push_back(structure("Late", {use("Point")}));
    edit.variables.push_back(variable("Added", use("Late")));
    edit.variables.push_back(variable("Also", use("Axis")));
    const ProgramTypes types = ProgramTypes::create(edit).value();
    Publication& publication = machine.published.publication;
    publication.add(types);

    SECTION("with handles after theirs")
    {
        REQUIRE(machine.nodes.add_variables(machine.space, publication));
        CHECK(machine.space.variable(machine.find("Added")).handle == 6);
        CHECK(machine.space.variable(machine.find("Also")).handle == 7);
        CHECK(machine.find("Types/Late") != model::no_node);
        CHECK(machine.state("NumberOfPublishedVariables") == Variant{std::uint32_t{8}});
        // Nothing is added twice.
        CHECK(machine.nodes.add_variables(machine.space, publication));
    }
    SECTION("all of them or none")
    {
        model::NewNode node;
        node.id = NodeId{machine.nodes.namespace_index(), "Also"};
        node.browse_name = QualifiedName{1, "Also"};
        node.parent = machine.space.find(id::ObjectsFolder);
        const model::NodeIndex obstacle = machine.space.add_folder(node).value();
        const auto failed = machine.nodes.add_variables(machine.space, publication);
        REQUIRE_FALSE(failed);
        CHECK(text(failed.error()) == "variables (Also): cannot be made a node (Bad_NodeIdExists)");
        CHECK(machine.find("Added") == model::no_node);
        CHECK(machine.state("NumberOfPublishedVariables") == Variant{std::uint32_t{6}});
        // Once the obstacle is gone, it works.
        REQUIRE(machine.space.remove(obstacle));
        REQUIRE(machine.nodes.add_variables(machine.space, publication));
        CHECK(machine.space.variable(machine.find("Also")).handle == 7);
    }
}

TEST_CASE("Ten thousand variables have their nodes (1-2-2)")
{
    Program program{.variables = numbered(10'001)};
    const Machine machine{program};
    CHECK(machine.state("NumberOfPublishedVariables") == Variant{std::uint32_t{10'000}});
    CHECK(machine.state("UnpublishedVariablesStatus") == Variant{std::uint16_t{1}});
    CHECK(machine.space.variable(machine.find("V09999")).handle == 9'999);
    CHECK(machine.find("V10000") == model::no_node);
}

TEST_CASE("Names of variables, types and the controller do not meet (6-2-1)")
{
    Program program = machine_program();
    for (const char* name : {"NJ_1", "Controller", "GlobalVars", "DeviceState", "Point"}) {
        program.variables.push_back(variable(name, use("Point")));
    }
    const Machine machine{program};
    CHECK(machine.state("NumberOfPublishedVariables") == Variant{std::uint32_t{11}});
}

TEST_CASE("A name that is taken is a problem with a place (6-2-1)")
{
    model::AddressSpace space;
    const Published published{machine_program()};
    REQUIRE(
        MachineNodes::create(space, published.program, published.publication, machine_options()));
    const auto again =
        MachineNodes::create(space, published.program, published.publication, machine_options());
    REQUIRE_FALSE(again);
    CHECK(text(again.error()) == "controller_name: cannot be made a folder (Bad_NodeIdExists)");
}

} // namespace machine_nodes_test
