#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/controller/retained_values.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "controller/publishing/program_parts.hpp"

namespace unpublished_test {

// RETAIN variables that no client sees.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

Program with_types()
{
    Program program;
    program.types = {structure("Point", {use(ElementaryType::Int), use(ElementaryType::Lreal)})};
    program.variables = {variable("Speed"), variable("Home", use("Point"))};
    return program;
}

/// RETAIN variables: one that is published, hidden ones, one of a union, and a constant.
Program keeping_program()
{
    Program program = with_types();
    program.types.push_back(union_of("Either", {use(ElementaryType::Int)}));
    const auto hidden = [](std::string name, TypeUse type = {}) {
        GlobalVariable made = variable(std::move(name), std::move(type));
        made.publish = NetworkPublish::Hidden;
        made.is_retained = true;
        return made;
    };
    program.variables.insert(program.variables.begin(),
                             {hidden("Kept", use("Point")), hidden("Other", use("Either")),
                              hidden("Fixed"), hidden("Last")});
    program.variables[2].is_constant = true;
    program.variables.push_back(variable("Seen"));
    program.variables.back().is_retained = true;
    return program;
}

} // namespace

TEST_CASE("RETAIN variables that are not published lie behind those that are (6-2-2)")
{
    const auto program = PublishedProgram::create(keeping_program(), nj501_publishing()).value();
    auto made = program->make_image(1).value();
    CHECK(program->publication().published().size() == 3); // Home, Seen, Speed
    CHECK(std::ranges::equal(program->handles(), std::vector<std::uint32_t>{0, 1, 2}));
    REQUIRE(made.image()->size() == 5);
    const auto& variables = program->program().variables;
    CHECK(variables[made.variables()[3]].name == "Kept");
    CHECK(variables[made.variables()[4]].name == "Last");
}

TEST_CASE("What is published online has the memory in which it was kept (4-2-5)")
{
    const auto program = PublishedProgram::create(keeping_program(), nj501_publishing()).value();
    auto made = program->make_image(1).value();
    Program edited = keeping_program();
    edited.variables[3].publish = NetworkPublish::PublishOnly; // Last
    edited.variables.push_back(variable("Fresh"));
    GlobalVariable more = variable("More");
    more.publish = NetworkPublish::Hidden;
    more.is_retained = true;
    edited.variables.push_back(more);
    const auto added = program->edit(edited, 1, made);
    INFO((added ? "" : text(added.error())));
    REQUIRE(added);
    CHECK(added->image.first_handle == 5);
    CHECK(made.image()->size() == 7); // with Fresh and More
    // Home, Seen, Speed, and those of the edit: Fresh, Last.
    CHECK(std::ranges::equal(program->handles(), std::vector<std::uint32_t>{0, 1, 2, 5, 4}));

    model::AddressSpace space;
    MachineNodesOptions options;
    const auto first = PublishedProgram::create(keeping_program(), nj501_publishing()).value();
    auto nodes =
        MachineNodes::create(space, first->program(), first->publication(), options).value();
    REQUIRE(nodes.add_variables(space, program->publication(), program->handles()));
    CHECK(space.variable(space.find(NodeId{1, "Last"})).handle == 4);
    CHECK(space.variable(space.find(NodeId{1, "Fresh"})).handle == 5);
    CHECK(space.find(NodeId{1, "More"}) == model::no_node);
}

TEST_CASE("A RETAIN variable that is not published is kept over a restart (6-2-2)")
{
    storage::MemoryStorage storage;
    const auto start = [&](std::int16_t expected, std::int16_t next) {
        const auto program =
            PublishedProgram::create(keeping_program(), nj501_publishing()).value();
        auto made = program->make_image(1).value();
        RetainedValues retained{storage, program->types(), made};
        CHECK(retained.size() == 3); // with Seen
        CHECK(retained.restore().problems.empty());
        CHECK(made.image()->memory().value<std::int16_t>(4) == expected);
        CHECK(made.image()->memory().structure(3).value<std::int16_t>(0) == expected);
        made.image()->memory().value<std::int16_t>(4) = next;
        made.image()->memory().structure(3).value<std::int16_t>(0) = next;
        made.image()->begin_scan();
        made.image()->publish(DateTime{1});
        CHECK(retained.save());
    };
    start(0, 42);
    start(42, 43);
    start(43, 44);
}

} // namespace unpublished_test
