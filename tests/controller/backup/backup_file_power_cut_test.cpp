#include <catch2/catch.hpp>

#include "memory_fixture.hpp"
#include "support/effort.hpp"

namespace backup_file_power_cut_test {

// A backup from the controller's storage to a file on a card and back, on media that fail.

using namespace busbar;
using namespace busbar::controller;
using busbar::test::MemoryFixture;

namespace {

constexpr const char* backup_name = "backup.dat";

struct FirstMachine : MemoryFixture {
    FirstMachine() { put_all(test::first_machine()); }
};

/// What a machine that has other data makes of the file that was found on the card.
bool second_takes(std::span<const std::byte> file)
{
    MemoryFixture second;
    second.put_all(test::second_machine());
    const bool is_done = second.memory.restore(file, {}).has_value();
    CHECK(second.files() == (is_done ? test::second_restored() : test::second_machine()));
    return is_done;
}

} // namespace

TEST_CASE_METHOD(FirstMachine, "A backup only reads the controller's storage (8-2-1)",
                 "[power_cut][backup]")
{
    const std::vector<std::byte> backup = memory.backup({"press 4"}).value();
    const std::size_t steps = storage.steps();
    SECTION("full")
    {
        storage.set_capacity(0);
        CHECK(memory.backup({"press 4"}).value() == backup);
        storage.set_capacity(UINT64_MAX);
    }
    SECTION("protected")
    {
        storage.set_protected(true);
        CHECK(memory.backup({"press 4"}).value() == backup);
        storage.set_protected(false);
    }
    SECTION("away")
    {
        storage.set_away(true);
        CHECK_FALSE(memory.backup({"press 4"}));
        storage.set_away(false);
    }
    CHECK(storage.steps() == steps);
    CHECK(log.take().empty());
    CHECK(files() == test::first_machine());
    CHECK(memory.backup({"press 4"}).value() == backup);
}

TEST_CASE_METHOD(FirstMachine, "A backup file is whole or refused after a power cut (8-2-1)",
                 "[power_cut][backup]")
{
    const std::vector<std::byte> backup = memory.backup({"press 4"}).value();
    std::size_t refused = 0;
    bool is_written = false;
    const test::Turns cuts{"backup file", 61};
    for (std::size_t step = cuts.first; !is_written; step += cuts.stride) {
        // Written piece by piece, as tools do that know no other way.
        storage::MemoryStorage card;
        card.cut_power_after(step);
        is_written = card.append(backup_name, backup, FileAccess::Owner).has_value();
        card.restore_power();
        const auto found = read_file(card, backup_name, backup.size());
        const bool is_taken = found && second_takes(*found);
        refused += found && !is_taken ? 1U : 0U;
        if (is_taken != (found && *found == backup) || (is_written && !is_taken)) {
            FAIL("half a backup is taken after " << step << " steps");
        }
    }
    CHECK((refused + 1) * cuts.stride + cuts.first >= backup.size());
}

TEST_CASE_METHOD(FirstMachine, "An earlier backup stays until the next is whole (8-2-1)",
                 "[power_cut][backup]")
{
    const std::vector<std::byte> first = memory.backup({"press 4"}).value();
    put("users.json", "users 3");
    const std::vector<std::byte> next = memory.backup({"press 4"}).value();
    REQUIRE(first != next);
    bool is_written = false;
    const test::Turns cuts{"next backup file", 61};
    for (std::size_t step = cuts.first; !is_written; step += cuts.stride) {
        storage::MemoryStorage card;
        REQUIRE(card.replace(backup_name, first, FileAccess::Owner));
        card.cut_power_after(step);
        is_written = card.replace(backup_name, next, FileAccess::Owner).has_value();
        card.restore_power();
        const auto found = read_file(card, backup_name, next.size()).value();
        REQUIRE((found == next || (!is_written && found == first)));
    }
}

} // namespace backup_file_power_cut_test
