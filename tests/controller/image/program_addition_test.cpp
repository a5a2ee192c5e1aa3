#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <thread>

#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/published_program.hpp>

#include "controller/publishing/program_parts.hpp"
#include "support/source_caller.hpp"

namespace program_addition_test {

// Variables that an online edit adds to a program whose task runs, and takes out of it.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

constexpr std::uint16_t machine_namespace = 1;

Program first_program()
{
    Program program;
    program.types = {structure("Point", {use(ElementaryType::Int), use(ElementaryType::Lreal)})};
    program.variables = {variable("Speed"), variable("Home", use("Point"))};
    return program;
}

/// With a number, a constant, a structure within a structure, an array of structures.
Program edited_program()
{
    Program program = first_program();
    program.types.push_back(structure("Line", {use("Point"), use("Point")}));
    GlobalVariable top = variable("Top");
    top.is_constant = true;
    top.initial.value = std::int64_t{99};
    GlobalVariable track = variable("Track", array_of(use("point"), {{0, 2}}));
    InitialValue m0{.member = "m0", .value = std::int64_t{7}};
    track.initial.parts = {{.repeat = 2, .parts = {m0}}};
    program.variables.insert(program.variables.begin(),
                             {track, variable("Edge", use("Line")), top, variable("Count")});
    return program;
}

/// A running machine.
struct EditedMachine {
    explicit EditedMachine(const server::ImageOptions& options = {},
                           const PublishingLimits& limits = nj501_publishing())
        : program{PublishedProgram::create(first_program(), limits).value()},
          made{program->make_image(machine_namespace, {.image = options}).value()}
    {
        scan();
    }
    void scan()
    {
        image().begin_scan();
        image().publish(DateTime{++scans});
    }
    [[nodiscard]] server::ProcessImage& image() { return *made.image(); }
    [[nodiscard]] Configured<ProgramAddition> edit(Program edited)
    {
        return program->edit(std::move(edited), machine_namespace, made);
    }
    [[nodiscard]] std::string refusal(Program edited)
    {
        const auto added = edit(std::move(edited));
        return added ? "" : text(added.error());
    }
    [[nodiscard]] std::vector<std::string> published() const
    {
        std::vector<std::string> names;
        for (const PublishedVariable& each : program->publication().published()) {
            names.push_back(each.variable->name);
        }
        return names;
    }
    [[nodiscard]] std::vector<std::uint32_t> handles() const
    {
        return {program->handles().begin(), program->handles().end()};
    }

    std::int64_t scans{0};
    std::unique_ptr<PublishedProgram> program;
    ProgramImage made;
};

Program with_numbers(std::initializer_list<const char*> names)
{
    Program program = first_program();
    for (const char* name : names) {
        program.variables.push_back(variable(name));
    }
    return program;
}

} // namespace

TEST_CASE("What an online edit adds is published with the next scan (4-2-5)")
{
    EditedMachine machine;
    const auto added = machine.edit(edited_program());
    INFO((added ? "" : text(added.error())));
    REQUIRE(added);
    CHECK(added->group.first_published == 2);
    CHECK(added->image.first_handle == 2);
    const auto& published = machine.program->publication().published();
    REQUIRE(published.size() == 6);
    CHECK(machine.image().size() == 6);
    for (std::size_t i = 0; i < 4; ++i) { // in the order of their names
        static constexpr const char* names[] = {"Count", "Edge", "Top", "Track"};
        CHECK(published[2 + i].variable->name == names[i]);
        CHECK(published[2 + i].program == added->types);
        const auto& variables = added->types->program().variables;
        CHECK(variables[added->image.variables[i]].name == names[i]);
    }
    CHECK(machine.image().pin().bytes(2) == nullptr);
    machine.scan();
    const server::ImagePin pin = machine.image().pin();
    CHECK(pin.value(2) == Variant{std::int16_t{0}});
    CHECK(pin.value(4) == Variant{std::int16_t{99}});
    CHECK(pin.value(3).get_if<ExtensionObject>()->encoding_id() ==
          MachineTypes::encoding_of(machine_namespace, added->types->program().types[1]));
    CHECK(pin.value(5).array_if<ExtensionObject>()->size() == 3);
    server::ImageMemory& memory = *added->image.memory;
    CHECK(memory.structure(3, 1).value<std::int16_t>(0) == 7);
    CHECK(memory.structure(3, 2).value<std::int16_t>(0) == 0);
}

TEST_CASE("An online edit publishes a variable that was left out before (4-2-5)")
{
    Program before = first_program();
    before.variables.push_back(variable("Timer", use("TON")));
    auto program = PublishedProgram::create(
        CheckedProgram::create(std::move(before), Unserved::LeaveOut).value(), nj501_publishing());
    ProgramImage image = program->make_image(machine_namespace).value();
    REQUIRE(program->publication().unpublished().size() == 1);
    Program after = first_program();
    after.variables.push_back(variable("Timer"));
    REQUIRE(program->edit(std::move(after), machine_namespace, image));
    CHECK(program->publication().unpublished().empty());
    CHECK(program->publication().published().size() == 3);
}

TEST_CASE("An online edit follows another (4-2-5)")
{
    EditedMachine machine;
    CHECK(machine.edit(with_numbers({"B"}))->image.first_handle == 2);
    CHECK(machine.edit(with_numbers({"A", "B"}))->image.first_handle == 3);
    const auto none = machine.edit(with_numbers({"a", "b"}));
    REQUIRE(none);
    CHECK(none->image.variables.empty());
    CHECK(none->image.memory == nullptr);
    CHECK(none->image.first_handle == 4);
    CHECK(machine.image().size() == 4);
    CHECK(machine.program->program().variables.size() == 2);
    CHECK(machine.program->publication().published()[2].variable->name == "B");
}

TEST_CASE("What is hidden or above a limit is not added to the image (6-2-2)")
{
    PublishingLimits limits;
    limits.max_variables = 3;
    EditedMachine machine{{}, limits};
    Program edited = edited_program();
    edited.variables[3].publish = NetworkPublish::Hidden; // Count
    const auto added = machine.edit(edited);
    REQUIRE(added);
    CHECK(added->group.exceeded == PublishingLimit::Variables);
    CHECK(machine.image().size() == 3); // with Edge
    CHECK(machine.program->publication().left_out() == 2);
}

TEST_CASE("An online edit that changes what there is is refused, and adds nothing (4-2-5)")
{
    EditedMachine machine;
    Program edited = edited_program();
    static const std::string end = "; this requires a download instead of an online edit";
    SECTION("a type")
    {
        edited.types[0].members[0].type = use(ElementaryType::Dint);
        edited.types[0].place = {3, 1};
        CHECK(machine.refusal(edited) ==
              "3:1: types[0] (Point): already exists and was a different type" + end);
    }
    SECTION("the type of a variable")
    {
        edited.variables[4].type = use(ElementaryType::Uint);
        CHECK(machine.refusal(edited) ==
              "variables[4] (Speed): already exists and had another type" + end);
    }
    SECTION("whether it is a constant")
    {
        edited.variables[4].is_constant = true;
        CHECK(machine.refusal(edited) ==
              "variables[4] (Speed): already exists and was not a constant" + end);
    }
    SECTION("what an edit before has brought")
    {
        REQUIRE(machine.edit(with_numbers({"Later"})));
        edited = with_numbers({"Later"});
        edited.variables[2].type = use(ElementaryType::Bool);
        CHECK(machine.refusal(edited) ==
              "variables[2] (Later): already exists and had another type" + end);
        CHECK(machine.image().size() == 3);
        return;
    }
    SECTION("its initial values")
    {
        edited.variables[2].initial.value = std::int64_t{100'000};
        CHECK(machine.refusal(edited) != "");
    }
    SECTION("its types")
    {
        edited.variables[1].type = use("Nowhere");
        CHECK(machine.refusal(edited) != "");
    }
    CHECK(machine.image().size() == 2);
    CHECK(machine.program->publication().published().size() == 2);
    machine.scan();
    CHECK(machine.edit(edited_program())->image.first_handle == 2);
}

TEST_CASE("An image that cannot have what is added leaves the program as it is (4-2-5)")
{
    server::ImageOptions options;
    options.max_additions = 1;
    EditedMachine machine{options};
    Program large = with_numbers({"Large"});
    large.variables[2].type = array_of(use(ElementaryType::Lreal), {{0, 999'999}});
    CHECK(PublishedProgram::create(large, {}).value()->publication().published().size() == 3);
    EditedMachine unlimited{options, {}};
    CHECK(unlimited.refusal(large).find("more bytes than are written") != std::string::npos);
    CHECK(unlimited.program->publication().published().size() == 2);
    CHECK(machine.edit(with_numbers({"A"})));
    const auto second = machine.edit(with_numbers({"A", "B"}));
    REQUIRE_FALSE(second);
    CHECK(second.error().status == status::Bad_TooManyOperations);
    CHECK(machine.image().size() == 3);
    CHECK(machine.program->publication().published().size() == 3);
}

TEST_CASE("A constant that is added is read only, the rest is not (6-2-2)")
{
    EditedMachine machine;
    REQUIRE(machine.edit(edited_program()));
    machine.scan();
    std::atomic<bool> done{false};
    std::thread task{[&] {
        while (!done) {
            machine.scan();
        }
    }};
    std::vector<StatusCode> results;
    {
        server::ImageSource source{machine.made.image()};
        busbar::test::SourceCaller caller{source};
        const DataValue five{Variant{std::int16_t{5}}};
        results = caller.write({{2, nullptr, &five}, {4, nullptr, &five}});
    }
    done = true;
    task.join();
    CHECK(results == std::vector<StatusCode>{status::Good, status::Bad_NotWritable});
    CHECK(machine.image().pin().value(2) == Variant{std::int16_t{5}});
    CHECK(machine.image().pin().value(4) == Variant{std::int16_t{99}});
}

TEST_CASE("Scans go on within an addition (4-2-5)")
{
    EditedMachine machine;
    const Program edited = edited_program();
    const auto types = ProgramTypes::create(edited);
    REQUIRE(types);
    const std::int64_t before = machine.scans;
    const std::vector<std::size_t> indices{0, 1};
    const auto added = machine.made.add(*types, indices, [&](const DerivedType& type) {
        machine.scan();
        CHECK(machine.image().size() == 2);
        return MachineTypes::encoding_of(machine_namespace, type);
    });
    REQUIRE(added);
    CHECK(machine.scans > before);
    CHECK(machine.made.variables().size() == 2);
    CHECK(machine.image().size() == 4);
}

TEST_CASE("Nodes of what was added have the handles of the image (4-2-5)")
{
    EditedMachine machine;
    model::AddressSpace space;
    MachineNodesOptions options;
    auto nodes = MachineNodes::create(space, machine.program->program(),
                                      machine.program->publication(), options)
                     .value();
    REQUIRE(nodes.namespace_index() == machine_namespace);
    REQUIRE(machine.edit(edited_program()));
    REQUIRE(nodes.add_variables(space, machine.program->publication()));
    const auto& published = machine.program->publication().published();
    for (std::uint32_t handle = 0; handle < published.size(); ++handle) {
        const auto node =
            space.find(NodeId{machine_namespace, String{published[handle].variable->name}});
        REQUIRE(node != model::no_node);
        CHECK(space.variable(node).handle == handle);
    }
}

TEST_CASE("No structure is torn while arrays of them are added (4-2-5)")
{
    EditedMachine machine;
    std::atomic<bool> done{false};
    std::atomic<unsigned> torn{0};
    std::atomic<std::uint32_t> seen{0};
    constexpr std::uint32_t edits = 32;
    std::vector<std::atomic<server::ImageMemory*>> memories(edits);
    std::thread task{[&] {
        while (!done) {
            machine.image().begin_scan();
            const auto number = static_cast<std::int16_t>(machine.scans);
            for (const auto& memory : memories) {
                auto* const added = memory.load(std::memory_order_acquire);
                for (std::uint32_t i = 0; added != nullptr && i < 3; ++i) {
                    added->structure(0, i).value<std::int16_t>(0) = number;
                    added->structure(0, i).value<double>(1) = number;
                }
            }
            machine.image().publish(DateTime{++machine.scans});
        }
    }};
    std::thread reader{[&] {
        while (!done) {
            const server::ImagePin pin = machine.image().pin();
            std::uint32_t current = 0;
            for (std::uint32_t handle = 2; handle < machine.image().size(); ++handle) {
                const std::byte* const bytes = pin.bytes(handle);
                for (std::uint32_t i = 0; bytes != nullptr && i < 3; ++i) {
                    std::int16_t number = 0;
                    double same = 0;
                    const auto& members = machine.image().place(handle).structure->members();
                    const std::byte* const element = bytes + i * machine.image().place(2).stride;
                    std::memcpy(&number, element + members[0].offset, sizeof number);
                    std::memcpy(&same, element + members[1].offset, sizeof same);
                    torn += same != number ? 1U : 0U;
                    current += i == 2 && number != 0 ? 1U : 0U;
                }
            }
            seen = std::max(seen.load(), current);
        }
    }};
    Program edited = first_program();
    for (std::uint32_t i = 0; i < edits; ++i) {
        edited.variables.push_back(
            variable("T" + std::to_string(i), array_of(use("Point"), {{0, 2}})));
        const auto added = machine.edit(edited);
        CHECK(added);
        if (added) {
            memories[i].store(added->image.memory, std::memory_order_release);
        }
    }
    while (seen < edits) {
        std::this_thread::yield();
    }
    done = true;
    task.join();
    reader.join();
    CHECK(torn == 0);
}

TEST_CASE("What an online edit deletes is published no more, and the others stay (3-3-2)")
{
    EditedMachine machine;
    REQUIRE(machine.edit(edited_program()));
    Program edited = edited_program();
    std::erase_if(edited.variables, [](const auto& each) {
        return each.name == "Speed" || each.name == "Edge" || each.name == "Track";
    });
    const auto done = machine.edit(edited);
    INFO((done ? "" : text(done.error())));
    REQUIRE(done);
    CHECK(done->removed == std::vector<std::string>{"Speed", "Edge", "Track"});
    CHECK(done->group.first_published == 3);
    CHECK(machine.published() == std::vector<std::string>{"Home", "Count", "Top"});
    CHECK(machine.handles() == std::vector<std::uint32_t>{0, 2, 4});
    const Publication& publication = machine.program->publication();
    CHECK(publication.values() == 4);
    CHECK(publication.data_types() == 1); // Line is used no more
    CHECK(machine.image().size() == 6);   // their places stay unused
    SECTION("one that comes back has a place of its own, and may be of another type")
    {
        edited.variables.push_back(variable("speed", use(ElementaryType::Lreal)));
        REQUIRE(machine.edit(edited));
        CHECK(machine.handles() == std::vector<std::uint32_t>{0, 2, 4, 6});
        machine.scan();
        CHECK(machine.image().pin().value(6) == Variant{0.0});
    }
    SECTION("a refused edit deletes nothing")
    {
        edited.variables = {variable("Home", use(ElementaryType::Bool))};
        CHECK(machine.refusal(edited) != "");
        CHECK(machine.published().size() == 3);
        CHECK(machine.handles() == std::vector<std::uint32_t>{0, 2, 4});
    }
    SECTION("a type that has DataTypes stays what it is")
    {
        edited.types.back() = structure("Line", {use("Point")});
        CHECK(machine.refusal(edited).find("types[1] (Line)") == 0);
    }
}

TEST_CASE("Another publish attribute shows and hides a variable where it is (3-3-1 and 3-3-2)")
{
    EditedMachine machine;
    Program edited = first_program();
    edited.variables[0].publish = NetworkPublish::Hidden;
    const auto hidden = machine.edit(edited);
    REQUIRE(hidden);
    CHECK(hidden->removed == std::vector<std::string>{"Speed"});
    CHECK(machine.published() == std::vector<std::string>{"Home"});
    const auto shown = machine.edit(first_program());
    REQUIRE(shown);
    CHECK(shown->removed.empty());
    CHECK(shown->image.variables.empty());
    CHECK(machine.published() == std::vector<std::string>{"Home", "Speed"});
    CHECK(machine.handles() == std::vector<std::uint32_t>{0, 1});
    edited.variables[0].publish = NetworkPublish::Output; // the same to OPC UA
    CHECK(machine.edit(edited)->removed.empty());
    CHECK(machine.handles() == std::vector<std::uint32_t>{0, 1});
}

TEST_CASE("A variable that becomes RETAIN is kept where it is (3-3-2)")
{
    EditedMachine machine;
    Program edited = first_program();
    edited.variables[0].is_retained = true;
    const auto done = machine.edit(edited);
    REQUIRE(done);
    REQUIRE(done->retained.size() == 1);
    CHECK(done->retained[0].first_handle == machine.handles()[1]);
    CHECK(done->retained[0].variables == std::vector<std::size_t>{0});
    CHECK(machine.edit(edited)->retained.empty());
    CHECK(machine.edit(first_program())->retained.empty());
}

TEST_CASE("What is deleted makes room for what is added (6-2-2)")
{
    PublishingLimits limits;
    limits.max_variables = 2;
    EditedMachine machine{{}, limits};
    REQUIRE(machine.edit(with_numbers({"A"}))->group.exceeded == PublishingLimit::Variables);
    CHECK(machine.program->publication().left_out() == 1);
    Program edited = with_numbers({"B"}); // without A, that nobody saw
    edited.variables.erase(edited.variables.begin());
    REQUIRE(machine.edit(edited));
    CHECK(machine.published() == std::vector<std::string>{"Home", "B"});
    CHECK(machine.program->publication().left_out() == 0);
    CHECK_FALSE(machine.program->publication().exceeds(PublishingLimit::Variables));
}

TEST_CASE("Nodes of what was deleted go, and come again with what comes again (3-3-2)")
{
    EditedMachine machine;
    model::AddressSpace space;
    MachineNodesOptions options;
    auto nodes = MachineNodes::create(space, machine.program->program(),
                                      machine.program->publication(), options)
                     .value();
    const auto edit = [&](const Program& edited) {
        const auto done = machine.edit(edited);
        REQUIRE(done);
        nodes.remove_variables(space, done->removed);
        REQUIRE(
            nodes.add_variables(space, machine.program->publication(), machine.program->handles()));
    };
    const auto is_there = [&](const char* name) {
        return space.find(NodeId{machine_namespace, name}) != model::no_node;
    };
    Program edited = with_numbers({"More"});
    edited.variables.erase(edited.variables.begin());
    edit(edited);
    CHECK_FALSE(is_there("Speed"));
    CHECK(is_there("Home"));
    CHECK(is_there("More"));
    edit(first_program());
    CHECK_FALSE(is_there("More"));
    CHECK(space.variable(space.find(NodeId{machine_namespace, "Speed"})).handle == 3);
}

} // namespace program_addition_test
