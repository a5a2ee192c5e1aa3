#include <catch2/catch.hpp>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "machine_parts.hpp"

namespace machine_types_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

MachineTypeOptions typed()
{
    return {ElementaryTypes::BuiltIn, true};
}

} // namespace

TEST_CASE("Elementary types are those of OPC UA in the preset (6-2-2, basic data types)")
{
    const std::pair<ElementaryType, std::uint32_t> table[] = {
        {ElementaryType::Bool, id::Boolean},  {ElementaryType::Sint, id::SByte},
        {ElementaryType::Usint, id::Byte},    {ElementaryType::Byte, id::Byte},
        {ElementaryType::Int, id::Int16},     {ElementaryType::Uint, id::UInt16},
        {ElementaryType::Word, id::UInt16},   {ElementaryType::Dint, id::Int32},
        {ElementaryType::Udint, id::UInt32},  {ElementaryType::Dword, id::UInt32},
        {ElementaryType::Lint, id::Int64},    {ElementaryType::Ulint, id::UInt64},
        {ElementaryType::Lword, id::UInt64},  {ElementaryType::Real, id::Float},
        {ElementaryType::Time, id::Double},   {ElementaryType::Lreal, id::Double},
        {ElementaryType::String, id::String}, {ElementaryType::DateAndTime, id::DateTime},
        {ElementaryType::Date, id::DateTime}, {ElementaryType::TimeOfDay, id::DateTime},
    };
    CHECK(std::size(table) == static_cast<std::size_t>(ElementaryType::String) + 1);
    for (const auto& [type, expected] : table) {
        INFO(name(type));
        const MachineDataType found = data_type_of(type, nj501_types().elementary, 3);
        CHECK(found.data_type == NodeId{0, expected});
        CHECK(static_cast<std::uint32_t>(found.built_in) == expected);
    }
}

TEST_CASE("Structures have DataTypes, enumerations are Int32 in the preset (6-2-2)")
{
    const Machine machine{machine_program()};
    const model::SpaceReader& space = machine.space;
    const std::uint16_t ns = machine.nodes.namespace_index();
    model::DataTypes data_types;
    const binary::DynamicTypes& types = data_types.of(space);
    CHECK(types.errors().empty());

    const binary::DynamicType* const axis = types.find(NodeId{ns, "Types/Axis"});
    REQUIRE(axis != nullptr);
    CHECK(axis->name == "Axis");
    CHECK(axis->encoding_id == NodeId{ns, "Types/Axis/Default Binary"});
    REQUIRE(axis->fields.size() == 5);
    CHECK(axis->fields[0].type == types.find(NodeId{ns, "Types/Point"}));
    CHECK(axis->fields[0].is_structure);
    CHECK(axis->fields[1].value_rank == 1);
    CHECK(axis->fields[1].array_dimensions == std::vector<std::uint32_t>{2});
    CHECK(axis->fields[2].data_type == NodeId{0, id::Int32});
    CHECK(axis->fields[3].built_in == BuiltInType::Float);
    CHECK(axis->fields[4].max_string_length == 20);
    CHECK(types.find(NodeId{ns, "Types/Point"})->fields[1].built_in == BuiltInType::Double);

    // What no published variable uses has no node.
    CHECK(machine.find("Types/Unused") == model::no_node);
    CHECK(machine.find("Types/Mode") == model::no_node);
    CHECK(space.attribute(machine.find("Types/Point"), AttributeId::Description).value() ==
          Variant{LocalizedText{"Where it is"}});
}

TEST_CASE("Enumerations have types of their own by default (6-2-2)")
{
    const Machine machine{machine_program(), {}, machine_options(typed())};
    const model::SpaceReader& space = machine.space;
    const model::NodeIndex mode = machine.find("Types/Mode");
    REQUIRE(mode != model::no_node);
    CHECK(space.is_subtype_of(mode, id::Enumeration));
    CHECK(space.data_type_id(machine.find("State")) == space.node_id(mode));
    const model::NodeIndex strings = model::find_by_path(space, mode, "EnumStrings");
    REQUIRE(strings != model::no_node);
    CHECK(space.value(strings) ==
          Variant{Array<LocalizedText>{LocalizedText{"Off"}, LocalizedText{"On"}}});
    model::DataTypes data_types;
    const auto& types = data_types.of(space);
    CHECK(types.errors().empty());
    const auto* const axis = types.find(NodeId{machine.nodes.namespace_index(), "Types/Axis"});
    REQUIRE(axis != nullptr);
    CHECK(axis->fields[2].built_in == BuiltInType::Int32);
    CHECK(axis->fields[2].data_type == space.node_id(mode));
}

TEST_CASE("Who makes values finds types and encodings (6-2-2, structures)")
{
    const Machine machine{machine_program(), {}, machine_options(typed())};
    const ProgramTypes& program = machine.published.types;
    const MachineTypes& types = machine.nodes.types();
    const std::uint16_t ns = machine.nodes.namespace_index();
    const MachineDataType point = types.of(program.resolve(array_of(use("POINT"), {{0, 1}})));
    CHECK(point.data_type == NodeId{ns, "Types/Point"});
    CHECK(point.encoding == NodeId{ns, "Types/Point/Default Binary"});
    CHECK(point.built_in == BuiltInType::ExtensionObject);
    CHECK(types.of(program.resolve(use("Mode"))).built_in == BuiltInType::Int32);
    CHECK(types.of(program.resolve(use("Mode"))).encoding.is_null());
    CHECK(types.of(program.resolve(use("Unused"))).data_type.is_null());
    CHECK(types.of(program.resolve(use(ElementaryType::Time))).built_in == BuiltInType::Double);

    // A value of such a type is one that the Variable may have.
    model::DataTypes data_types;
    const auto* const type = data_types.of(machine.space).find(point.data_type);
    REQUIRE(type != nullptr);
    const auto object = binary::to_extension_object(binary::DynamicValue{*type}).value();
    const model::NodeIndex points = machine.find("Points");
    CHECK(machine.space.check_value(Variant{Array<ExtensionObject>{object, object, object, object}},
                                    machine.space.find(machine.space.data_type_id(points)), 1,
                                    machine.space.variable(points).array_dimensions) ==
          status::Good);
}

TEST_CASE("Unions become Unions where they are allowed (6-2-2)")
{
    Program program;
    program.types = {union_of("Either", {use(ElementaryType::Int), use(ElementaryType::Lreal)})};
    program.variables = {variable("x", use("Either"))};
    const ProgramTypes types = ProgramTypes::create(program).value();
    model::AddressSpace space;
    const auto nodes =
        MachineNodes::create(space, program, Publication{types}, machine_options()).value();
    model::DataTypes data_types;
    const auto* const type =
        data_types.of(space).find(NodeId{nodes.namespace_index(), "Types/Either"});
    REQUIRE(type != nullptr);
    CHECK(type->kind == binary::DynamicType::Kind::Union);
    CHECK(type->fields.size() == 2);
}

TEST_CASE("A type whose node is there already is a problem with a place (6-2-2)")
{
    model::AddressSpace space;
    const std::uint16_t ns = space.add_namespace(MachineNodesOptions{}.namespace_uri).value();
    model::NewNode node;
    node.id = NodeId{ns, "Types/Point"};
    node.browse_name = QualifiedName{ns, "Point"};
    node.parent = space.find(id::Structure);
    REQUIRE(space.add_data_type(node, {}));
    const Published published{machine_program()};
    const auto nodes =
        MachineNodes::create(space, published.program, published.publication, machine_options());
    REQUIRE_FALSE(nodes);
    CHECK(nodes.error().status == status::Bad_NodeIdExists);
    CHECK(nodes.error().where == "types[1] (Point)");
}

} // namespace machine_types_test
