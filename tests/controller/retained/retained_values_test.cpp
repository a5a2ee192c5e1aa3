#include <catch2/catch.hpp>

#include "retained_fixture.hpp"

namespace retained_values_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

std::vector<std::byte> file_of(storage::MemoryStorage& storage)
{
    return read_file(storage, "retained", 1'000'000).value();
}

} // namespace

TEST_CASE("Retained values outlast a restart, others begin anew (6-2-2)")
{
    storage::MemoryStorage storage;
    {
        RetainingController first{storage};
        CHECK(first.retained->size() == 3);
        CHECK(first.restored.restored == 0);
        CHECK(first.restored.problems.empty());
        CHECK(first.retained->save()); // of no scan
        CHECK(storage.names().empty());
        first.work(42);
        first.memory().structure(2, 0).value<bool>(0) = true;
        first.scan();
        CHECK(first.retained->save());
    }
    RetainingController second{storage};
    CHECK(second.restored.restored == 3);
    CHECK(second.restored.problems.empty());
    CHECK(second.number() == 42);
    CHECK(second.memory().structure(2, 0).value<bool>(0));
    CHECK(second.memory().value<std::int32_t>(3) == 0);
}

TEST_CASE("A value whose variable has another type is dropped, the others are restored (6-2-2)")
{
    storage::MemoryStorage storage;
    RetainingController first{storage};
    first.work(42);
    REQUIRE(first.retained->save());
    Program changed = retaining_program();
    SECTION("an elementary type of the same size")
    {
        changed.variables[0].type.elementary = ElementaryType::Udint;
    }
    SECTION("a subrange")
    {
        changed.variables[0].type.subrange = Bounds{0, 10};
    }
    SECTION("an array of one")
    {
        changed.variables[0].type.dimensions = {{0, 0}};
    }
    RetainingController second{storage, changed};
    CHECK(second.restored.restored == 2);
    REQUIRE(second.restored.problems.size() == 1);
    CHECK(second.restored.problems[0].where == "retained: Count");
    CHECK(second.memory().text(1) == "recipe 42");
    CHECK(second.memory().load(0) != Variant{42});
}

TEST_CASE("Members count for the type of a structure, its name does not (6-2-2)")
{
    storage::MemoryStorage storage;
    RetainingController first{storage};
    first.work(42);
    REQUIRE(first.retained->save());
    Program changed = retaining_program();
    changed.types[0].name = "Shaft";
    changed.variables[2].type.type_name = "Shaft";
    CHECK(RetainingController{storage, changed}.restored.restored == 3);
    changed.types[0].members[1].name = "Label";
    RetainingController second{storage, changed};
    CHECK(second.restored.restored == 2);
    REQUIRE(second.restored.problems.size() == 1);
    CHECK(second.restored.problems[0].where == "retained: Axes");
    CHECK(second.memory().structure(2, 1).text(1) == "");
}

TEST_CASE("Variables that come, go or are named in other letters (6-2-2)")
{
    storage::MemoryStorage storage;
    RetainingController first{storage};
    first.work(42);
    REQUIRE(first.retained->save());
    Program changed = retaining_program();
    changed.variables[0].name = "COUNT";
    changed.variables[1].name = "Other";
    changed.variables[3].is_retained = true;
    RetainingController second{storage, changed};
    CHECK(second.restored.restored == 2);
    CHECK(second.restored.problems.empty());
    CHECK(second.count() == 42);
    CHECK(second.memory().text(1) == "");
}

TEST_CASE("Values are written at an interval, if they have changed (6-2-2)")
{
    storage::MemoryStorage storage;
    RetainingController plc{storage};
    TimePoint now{};
    CHECK(plc.retained->next_deadline() <= now);
    plc.work(1);
    CHECK(plc.retained->handle_deadline(now));
    CHECK(plc.retained->next_deadline() == now + 1min);
    const std::size_t steps = storage.steps();
    now += 1min;
    plc.memory().value<std::int32_t>(3) = 9; // not retained
    plc.scan();
    CHECK(plc.retained->handle_deadline(now));
    CHECK(storage.steps() == steps);
    plc.work(2);
    CHECK(plc.retained->handle_deadline(now));
    CHECK(storage.steps() > steps);
    RetainingController next{storage};
    CHECK(next.number() == 2);
    const std::size_t after = storage.steps();
    next.scan();
    CHECK(next.retained->save()); // the file has it
    CHECK(storage.steps() == after);
}

TEST_CASE("Retained variables of an online edit are kept too (4-2-5)")
{
    storage::MemoryStorage storage;
    Program edited = retaining_program();
    edited.variables.push_back({.name = "Added",
                                .type = {.elementary = ElementaryType::Dint},
                                .initial = {.value = std::int64_t{5}},
                                .is_retained = true});
    edited.variables.push_back({.name = "Fleeting", .type = {.elementary = ElementaryType::Dint}});
    {
        RetainingController first{storage};
        first.work(42);
        const auto types = ProgramTypes::create(edited).value();
        const auto encoding = [](const DerivedType&) { return NodeId{1, 1}; };
        const std::vector<std::size_t> indices{5, 4};
        const auto added = first.made->add(types, indices, encoding).value();
        first.retained->add(types, added);
        CHECK(first.retained->size() == 4);
        CHECK(first.retained->save()); // of a scan without it
        CHECK(RetainingController{storage}.restored.restored == 3);
        added.memory->value<std::int32_t>(0) = 8;
        added.memory->value<std::int32_t>(1) += 1;
        first.scan();
        CHECK(first.retained->save());
        CHECK(first.retained->restore().restored == 3); // those that the task began with
        CHECK(added.memory->value<std::int32_t>(1) == 6);
    }
    RetainingController second{storage, edited};
    CHECK(second.restored.restored == 4);
    CHECK(second.restored.problems.empty());
    CHECK(second.number() == 42);
    CHECK(second.memory().value<std::int32_t>(4) == 6);
    CHECK(second.memory().value<std::int32_t>(5) == 0);
}

TEST_CASE("A damaged file is told of and kept; the start goes on (6-2-2)")
{
    storage::MemoryStorage storage;
    RetainingController first{storage};
    first.work(42);
    REQUIRE(first.retained->save());
    const auto good = file_of(storage);
    for (std::size_t i = 0; i <= good.size(); ++i) {
        auto bad = good;
        if (i == good.size()) {
            bad.push_back(std::byte{0});
        } else {
            bad[i] ^= std::byte{0x10};
        }
        REQUIRE(storage.replace("retained", bad, FileAccess::Owner));
        RetainingController second{storage};
        CHECK(second.restored.restored == 0);
        CHECK(second.restored.problems.size() == 1);
        CHECK(second.number() == 0);
        second.work(7);
        CHECK(second.retained->save());
        CHECK(read_file(storage, "retained.kept", 1'000'000).value() == bad);
        CHECK(RetainingController{storage}.number() == 7);
    }
    for (std::size_t size = 0; size < good.size(); ++size) {
        REQUIRE(storage.replace("retained", std::span{good}.first(size), FileAccess::Owner));
        CHECK(RetainingController{storage}.restored.problems.size() == 1);
    }
}

} // namespace retained_values_test
