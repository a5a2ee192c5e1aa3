#include <catch2/catch.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/project_store.hpp>
#include <busbar/controller/published_program.hpp>

#include "backup/memory_fixture.hpp"
#include "project/project_fixture.hpp"
#include "publishing/machine_parts.hpp"
#include "support/failing_worlds.hpp"

namespace allocation_failure_test {

// What a controller takes over with the k-th allocation failing, for k = 1, 2, ... until it goes
// through: it throws, nothing has changed, and the same succeeds at once.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;
using busbar::test::check_failing_worlds;
using busbar::test::fail_and_repeat;

namespace {

constexpr std::string_view declarations = R"(
TYPE Point : STRUCT x : INT := 3; y : ARRAY[0..2] OF LREAL; END_STRUCT END_TYPE
TYPE Mode : (Off, On := 4) INT; END_TYPE
VAR_GLOBAL RETAIN
    {attribute 'publish' := 'output'} Speed_of_the_conveyor : DINT := 7; // of the first one
    Home, Away : Point := (x := 5);
    State : Mode := On;
END_VAR
)";

Program edited_program()
{
    Program program = machine_program();
    program.types.push_back(structure("Line", {use("Point"), use("Point")}));
    program.variables.push_back(variable("Edge of the table", use("Line")));
    program.variables.push_back(variable("Count of the pieces that were made"));
    return program;
}

std::span<const std::byte> bytes_of(const std::string& text)
{
    return std::as_bytes(std::span{text});
}

std::string document_with_host(const std::string& host)
{
    Project project = busbar::test::press_project();
    project.network.host_name = host;
    return *document_of(project);
}

} // namespace

TEST_CASE("an allocation that fails while declarations are read ends that")
{
    check_failing_worlds("read_declarations", [](std::size_t k) {
        return fail_and_repeat(
            k, [] { return read_declarations(declarations, "machine.st").has_value(); });
    });
}

TEST_CASE("an allocation that fails while a program is published leaves none of it")
{
    check_failing_worlds("PublishedProgram", [](std::size_t k) {
        return fail_and_repeat(k, [] {
            const auto made = PublishedProgram::create(machine_program(), nj501_publishing());
            return made && (*made)->make_image(1);
        });
    });
}

TEST_CASE("an allocation that fails while a program gets nodes leaves nothing that is not theirs")
{
    check_failing_worlds("MachineNodes", [](std::size_t k) {
        return fail_and_repeat(k, [] {
            const Machine machine{machine_program()};
            return machine.nodes.namespace_index() != 0;
        });
    });
}

TEST_CASE("an allocation that fails in an online edit leaves the program as it was")
{
    check_failing_worlds("online edit", [](std::size_t k) {
        const auto program =
            PublishedProgram::create(machine_program(), nj501_publishing()).value();
        ProgramImage image = program->make_image(1).value();
        const auto before = program->handles().size();
        const bool has_failed = fail_and_repeat(
            k, [&] { return program->edit(edited_program(), 1, image).has_value(); });
        CHECK(program->handles().size() == before + 2);
        CHECK(program->handles().size() == program->publication().published().size());
        return has_failed;
    });
}

TEST_CASE("an allocation that fails while a project is checked or taken over leaves the one before")
{
    const std::string first = document_with_host("FIRST");
    const std::string second = document_with_host("SECOND");
    check_failing_worlds("ProjectStore", [&](std::size_t k) {
        storage::MemoryStorage storage;
        ProjectStore store{storage, "project", {}};
        REQUIRE(store.replace(bytes_of(first)));
        return fail_and_repeat(k, [&] {
            REQUIRE_FALSE(store.is_busy());
            REQUIRE(store.current() != nullptr);
            CHECK(store.current()->network.host_name == "FIRST");
            return store.replace(bytes_of(second)).has_value();
        });
    });
}

TEST_CASE("an allocation that fails in a backup or a restore leaves the files as they were")
{
    busbar::test::MemoryFixture first;
    first.put_all(busbar::test::first_machine());
    const auto backup = first.memory.backup({"NJ_1"}).value();
    const bool restores = GENERATE(false, true);
    check_failing_worlds(restores ? "restore" : "backup", [&](std::size_t k) {
        busbar::test::MemoryFixture second;
        second.put_all(busbar::test::second_machine());
        const bool has_failed = fail_and_repeat(k, [&] {
            if (!restores) {
                return second.memory.backup({"NJ_2"}).has_value();
            }
            return second.memory.restore(backup, {}).has_value();
        });
        const auto files = second.files();
        CHECK(files ==
              (restores ? busbar::test::second_restored() : busbar::test::second_machine()));
        return has_failed;
    });
}

} // namespace allocation_failure_test
