#include <catch2/catch.hpp>

#include <busbar/di/nodes.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/model/plcopen.hpp>
#include <busbar/plcopen/ids.hpp>
#include <busbar/plcopen/nodes.hpp>
#include <busbar/types/ids.hpp>

#include "machine_parts.hpp"

namespace machine_configuration_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

model::AddressSpace companion_space()
{
    model::AddressSpace space;
    REQUIRE(space.add(di::nodes()));
    REQUIRE(space.add(plcopen::nodes()));
    return space;
}

/// The problem that there is with a program's tasks and instances; "" for none.
std::string problem_of(const Program& program)
{
    model::AddressSpace space = companion_space();
    const Published published{program};
    const auto nodes =
        MachineNodes::create(space, published.program, published.publication, machine_options());
    return nodes ? "" : text(nodes.error());
}

} // namespace

TEST_CASE("Elementary types are those of PLCopen by default (6-2-2, basic data types)")
{
    const std::pair<ElementaryType, std::uint32_t> table[] = {
        {ElementaryType::Byte, plcopen::id::BYTE},
        {ElementaryType::Word, plcopen::id::WORD},
        {ElementaryType::Dword, plcopen::id::DWORD},
        {ElementaryType::Lword, plcopen::id::LWORD},
        {ElementaryType::Time, plcopen::id::TIME},
        {ElementaryType::Date, plcopen::id::DATE},
        {ElementaryType::TimeOfDay, plcopen::id::TOD},
        {ElementaryType::DateAndTime, plcopen::id::DT},
        {ElementaryType::String, plcopen::id::STRING},
    };
    const model::AddressSpace space = companion_space();
    const std::uint16_t ns = space.namespace_index(model::plcopen_uri).value();
    for (const auto& [type, expected] : table) {
        INFO(name(type));
        const MachineDataType found = data_type_of(type, ElementaryTypes::Plcopen, ns);
        CHECK(found.data_type == NodeId{ns, expected});
        CHECK(space.built_in_type_of(space.find(found.data_type)) == found.built_in);
    }
    CHECK(data_type_of(ElementaryType::Int, ElementaryTypes::Plcopen, ns).data_type ==
          NodeId{0, id::Int16});
}

TEST_CASE("Variables and members have the types of PLCopen by default (6-2-2)")
{
    const Machine machine{machine_program(), companion_space(), machine_options({})};
    const std::uint16_t ns = machine.space.namespace_index(model::plcopen_uri).value();
    CHECK(machine.nodes.types().elementary() == ElementaryTypes::Plcopen);
    CHECK(MachineTypes::elementary_in(machine.space, {}) == ElementaryTypes::Plcopen);
    CHECK(MachineTypes::elementary_in(machine.space, nj501_types()) == ElementaryTypes::BuiltIn);
    CHECK(MachineTypes::elementary_in(model::AddressSpace{}, {}) == ElementaryTypes::BuiltIn);
    CHECK(machine.space.data_type_id(machine.find("Limit")) == NodeId{ns, plcopen::id::WORD});
    model::DataTypes data_types;
    const auto& types = data_types.of(machine.space);
    CHECK(types.errors().empty());
    const auto* const point = types.find(NodeId{machine.nodes.namespace_index(), "Types/Point"});
    REQUIRE(point != nullptr);
    CHECK(point->fields[1].data_type == NodeId{ns, plcopen::id::TIME});
    CHECK(point->fields[1].built_in == BuiltInType::Int64);

    const Machine without{machine_program(), {}, machine_options({})};
    CHECK(without.nodes.types().elementary() == ElementaryTypes::BuiltIn);
}

TEST_CASE("The preset keeps to its table, whatever models there are (6-2-2)")
{
    const Machine machine{machine_program(), companion_space()};
    CHECK(machine.space.data_type_id(machine.find("Limit")) == NodeId{0, id::UInt16});
}

TEST_CASE("A configuration of PLCopen has resource, tasks, programs and variables (1-2-2)")
{
    Machine machine{machine_program(), companion_space()};
    const model::SpaceReader& space = machine.space;
    const model::NodeIndex configuration =
        model::find_by_path(space, model::find_di(space, model::di_id::DeviceSet), "NJ_1");
    REQUIRE(configuration != model::no_node);
    CHECK(space.type_definition(configuration) ==
          model::find_plcopen(space, model::plcopen_id::CtrlConfigurationType));
    CHECK(machine.find("PLCopen/Configuration") == configuration);

    const model::NodeIndex resource = model::find_by_path(space, configuration, "Resources/CPU");
    REQUIRE(resource != model::no_node);
    CHECK(space.value(model::find_by_path(space, resource, "SerialNumber")) == Variant{"4711"});
    const model::NodeIndex task = model::find_by_path(space, resource, "Tasks/Fast");
    REQUIRE(task != model::no_node);
    CHECK(space.value(model::find_by_path(space, task, "Interval")) == Variant{"T#1ms"});
    const model::NodeIndex first = model::find_by_path(space, resource, "Programs/Main1");
    const model::NodeIndex second = model::find_by_path(space, resource, "Programs/Main2");
    REQUIRE(first != model::no_node);
    REQUIRE(second != model::no_node);
    // "Main" and "MAIN" are one type.
    CHECK(space.type_definition(first) == space.type_definition(second));

    const model::NodeIndex globals = model::find_by_path(space, configuration, "GlobalVars");
    REQUIRE(globals != model::no_node);
    CHECK(model::find_by_path(space, globals, "Speed") == machine.find("Speed"));

    // Also what is added later.
    const Program edit{.variables = {variable("Added")}};
    const ProgramTypes types = ProgramTypes::create(edit).value();
    machine.published.publication.add(types);
    REQUIRE(machine.nodes.add_variables(machine.space, machine.published.publication));
    CHECK(model::find_by_path(space, globals, "Added") == machine.find("Added"));
}

TEST_CASE("Tasks and programs that make no sense are refused (1-2-2)")
{
    Program program = machine_program();
    CHECK(problem_of(program) == "");
    program.instances[0].task = "Slow";
    CHECK(problem_of(program) ==
          "instances[0] (Main1): is run by the task Slow, which is not declared");
    program = machine_program();
    program.instances[1].name = "Main1";
    CHECK(problem_of(program).find("instances[1] (Main1): cannot be made a node") == 0);
    program = machine_program();
    program.tasks.push_back(program.tasks[0]);
    CHECK(problem_of(program).find("tasks[1] (Fast): cannot be made a node") == 0);
}

} // namespace machine_configuration_test
