#pragma once

#include <catch2/catch.hpp>

#include <string>
#include <utility>

#include <busbar/controller/machine_nodes.hpp>
#include <busbar/model/instance.hpp>

#include "program_parts.hpp"

namespace busbar::controller::test {

/// A program with a structure in a structure, an enumeration and something of many kinds.
[[nodiscard]] inline Program machine_program()
{
    Program program;
    program.types = {
        structure("Axis", {use("Point"),
                           array_of(use("point"), {{0, 1}}),
                           use("Mode"),
                           array_of(use(ElementaryType::Real), {{0, 2}}),
                           {.elementary = ElementaryType::String, .string_length = 20}}),
        structure("Point", {use(ElementaryType::Int), use(ElementaryType::Time)}),
        {.name = "Mode",
         .kind = DerivedType::Kind::Enumeration,
         .enumerators = {{"Off", 0}, {"On", 1}}},
        structure("Unused", {use(ElementaryType::Int)})};
    program.types[1].comment = "Where it is";
    program.variables = {variable("Speed"),
                         variable("Axis1", use("AXIS")),
                         variable("Points", array_of(use("Point"), {{0, 3}})),
                         variable("State", use("Mode")),
                         variable("Grid", array_of(use(ElementaryType::Real), {{0, 1}, {0, 2}})),
                         variable("Limit", use(ElementaryType::Word))};
    program.variables[5].is_constant = true;
    program.tasks = {{.name = "Fast", .priority = 1, .interval = "T#1ms"}};
    program.instances = {{.name = "Main1", .type_name = "Main", .task = "fast"},
                         {.name = "Main2", .type_name = "MAIN"}};
    return program;
}

/// The preset of a product or the default.
[[nodiscard]] inline MachineNodesOptions machine_options(MachineTypeOptions types = nj501_types())
{
    MachineNodesOptions options;
    options.controller_name = "NJ_1";
    options.types = types;
    options.source = 4;
    options.nameplate.serial_number = "4711";
    return options;
}

/// A published program and its nodes.
struct Machine {
    explicit Machine(Program from, model::AddressSpace at = {},
                     const MachineNodesOptions& options = machine_options())
        : published{std::move(from)}, space{std::move(at)},
          nodes{MachineNodes::create(space, published.program, published.publication, options)
                    .value()}
    {
    }

    [[nodiscard]] model::NodeIndex find(const std::string& id) const
    {
        return space.find(NodeId{nodes.namespace_index(), String{id}});
    }
    [[nodiscard]] Variant state(const char* property) const
    {
        return space.value(find(std::string{"Controller/DeviceState/"} + property));
    }

    Published published;
    model::AddressSpace space;
    MachineNodes nodes;
};

} // namespace busbar::controller::test
