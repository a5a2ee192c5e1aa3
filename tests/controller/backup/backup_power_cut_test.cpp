#include <catch2/catch.hpp>

#include <functional>
#include <map>
#include <memory>

#include "memory_fixture.hpp"
#include "support/effort.hpp"

namespace backup_power_cut_test {

// Everything that changes a controller's data, cut at every byte and step, and on a medium that is
// full, protected or away.

using namespace busbar;
using namespace busbar::controller;
using busbar::test::MemoryFixture;
using test::Turns;

namespace {

using Files = MemoryFixture::Files;

const std::vector<std::byte>& first_backup()
{
    static const std::vector<std::byte> backup = [] {
        MemoryFixture machine;
        machine.put_all(test::first_machine());
        return *machine.memory.backup({"press 4"});
    }();
    return backup;
}

using Change = std::function<bool(MachineMemory&)>;

const std::map<std::string, Change> memory_changes{
    {"restore", [](MachineMemory& memory) { return !!memory.restore(first_backup(), {}); }},
    {"restore settings",
     [](MachineMemory& memory) {
         return !!memory.restore(first_backup(), {.security_profile = false});
     }},
    {"clear", [](MachineMemory& memory) { return !!memory.clear_all(true, MachineMode::Program); }},
    {"clear settings",
     [](MachineMemory& memory) { return !!memory.clear_all(false, MachineMode::Program); }},
};

Files after(const Change& change)
{
    MemoryFixture machine;
    machine.put_all(test::second_machine());
    REQUIRE(change(machine.memory));
    return machine.files();
}

/// What a controller has that starts on this storage now.
Files restarted(MemoryFixture& machine)
{
    MachineMemory memory{machine.storage, "restore", test::machine_items(), machine.log};
    REQUIRE(memory.recover());
    return machine.files();
}

/// How many steps an undisturbed change takes.
std::size_t steps_of(const Change& change, const Files& before)
{
    MemoryFixture machine;
    machine.put_all(before);
    const std::size_t begin = machine.storage.steps();
    REQUIRE(change(machine.memory));
    return machine.storage.steps() - begin;
}

} // namespace

TEST_CASE("A restore or clearing is whole or not done after a power cut (9-2-2, 35D00000)",
          "[power_cut][restore]")
{
    for (const auto& [what, change] : memory_changes) {
        INFO(what);
        const Files before = test::second_machine();
        const Files expected = after(change);
        REQUIRE(before != expected);
        std::size_t old_ones = 0;
        std::size_t new_ones = 0;
        bool is_undisturbed = false;
        // Each of the last steps, which come after the decision, and the others in turns.
        const Turns cuts{what, 5};
        const std::size_t steps = steps_of(change, before);
        for (std::size_t step = cuts.first; !is_undisturbed && step < 10'000;
             step += step + 30 < steps ? cuts.stride : 1) {
            MemoryFixture machine;
            machine.put_all(before);
            machine.storage.cut_power_after(step);
            const bool is_done = change(machine.memory);
            const bool is_dark = !machine.storage.free_space();
            machine.storage.restore_power();
            const Files found = restarted(machine);
            if (found != expected && (is_done || found != before)) {
                FAIL("half of it is done after " << step << " steps");
            }
            (found == before ? old_ones : new_ones) += 1;
            is_undisturbed = !is_dark;
        }
        CHECK(is_undisturbed);
        CHECK(old_ones * cuts.stride > 100);
        CHECK(new_ones > 1);
    }
}

TEST_CASE("A power cut while a power cut is mended is mended, too (9-2-2, 35D00000)",
          "[power_cut][restore]")
{
    const Files before = test::second_machine();
    const Change& change = memory_changes.at("restore");
    const Files expected = after(change);
    std::size_t mended = 0;
    const Turns cuts{"mended", 3};
    for (std::size_t first = cuts.first; first < 10'000; first += cuts.stride) {
        const auto cut = [&] {
            auto machine = std::make_unique<MemoryFixture>();
            machine->put_all(before);
            machine->storage.cut_power_after(first);
            static_cast<void>(change(machine->memory));
            const bool is_dark = !machine->storage.free_space();
            machine->storage.restore_power();
            return is_dark ? std::move(machine) : nullptr;
        };
        auto machine = cut();
        if (machine == nullptr) {
            break;
        }
        // Only what was decided is of interest.
        if (!machine->storage.entry("restore/journal.json")) {
            continue;
        }
        for (std::size_t second = 0; second < 40; ++second) {
            machine = cut();
            machine->storage.cut_power_after(second);
            static_cast<void>(machine->memory.recover());
            machine->storage.restore_power();
            REQUIRE(restarted(*machine) == expected);
            mended += cuts.stride;
        }
    }
    CHECK(mended > 100);
}

TEST_CASE("A medium that is full, protected or away changes nothing (8-2-2)",
          "[power_cut][restore]")
{
    using Fault = std::function<void(storage::MemoryStorage&, bool)>;
    const std::map<std::string, Fault> faults{
        {"full", [](auto& storage, bool is_on) { storage.set_capacity(is_on ? 600 : UINT64_MAX); }},
        {"protected", [](auto& storage, bool is_on) { storage.set_protected(is_on); }},
        {"away", [](auto& storage, bool is_on) { storage.set_away(is_on); }},
    };
    for (const auto& [name, set] : faults) {
        for (const auto& [what, change] : memory_changes) {
            INFO(what << ", " << name);
            MemoryFixture machine;
            machine.put_all(test::second_machine());
            set(machine.storage, true);
            CHECK_FALSE(change(machine.memory));
            CHECK(machine.log.take().empty());
            set(machine.storage, false);
            CHECK(machine.files() == test::second_machine());
            CHECK(change(machine.memory));
            CHECK(machine.files() == after(change));
        }
    }
}

TEST_CASE("A step that fails once leaves nothing half done (8-2-2)", "[power_cut][restore]")
{
    const Change& change = memory_changes.at("restore");
    const Files expected = after(change);
    std::size_t failed = 0;
    for (std::size_t step = 0; step < 3'000; step += 7) {
        MemoryFixture machine;
        machine.put_all(test::second_machine());
        machine.storage.fail_once_after(step, StorageError::Failed);
        const bool is_done = change(machine.memory);
        failed += is_done ? 0U : 1U;
        const Files found = restarted(machine);
        REQUIRE(found == (is_done ? expected : test::second_machine()));
    }
    CHECK(failed > 50);
}

TEST_CASE("A backup has what was transferred, whatever failed then (3-2-9)", "[power_cut][restore]")
{
    bool is_undisturbed = false;
    std::size_t transferred = 0;
    for (std::size_t step = 0; !is_undisturbed; ++step) {
        MemoryFixture machine;
        machine.put_all(test::second_machine());
        MachineSettings settings{machine.storage, "server.json", "security.json", "restore"};
        machine.put("security.json", document_of(SecuritySettings{}));
        REQUIRE(settings.load());
        ServerSettings wanted = settings.server();
        wanted.port = 5'500;
        const std::size_t begin = machine.storage.steps();
        machine.storage.fail_once_after(step, StorageError::Away);
        transferred += settings.transfer(wanted, MachineMode::Program) ? 1U : 0U;
        is_undisturbed = machine.storage.steps() - begin < step;
        machine.storage.restore_power();
        const auto backup = machine.memory.backup({"press 4"});
        REQUIRE(backup);
        MemoryFixture another;
        REQUIRE(another.memory.restore(*backup, {}));
        INFO("fails after " << step << " steps");
        REQUIRE(another.files()["server.json"] == document_of(settings.server()));
    }
    CHECK(transferred > 2);
}

} // namespace backup_power_cut_test
