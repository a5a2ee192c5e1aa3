#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "controller/life/logged_life.hpp"
#include "support/effort.hpp"
#include "virtual_machine.hpp"

namespace machine_power_cut_test {

// The whole controller on one medium whose power goes at any byte.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

void do_at_once(Duration, const std::function<void()>& what)
{
    what();
}

Program counting_program()
{
    Program program;
    program.variables = {
        {.name = "Counter", .publish = NetworkPublish::PublishOnly, .is_retained = true}};
    return program;
}

ServerSettings used_at(std::uint32_t port)
{
    ServerSettings settings = LifeFixture::used();
    settings.port = port;
    return settings;
}

/// Start, Prepare, PublishedVariable, NumOfVariables and Run.
constexpr std::size_t lines_of_start = 5;
constexpr std::size_t lines_of_download = 4;

/// In the order in which the controller gets them.
constexpr std::array<std::uint32_t, 3> ports_in_turn{4'840, 4'850, 4'860};

/// Of a controller whose port is the last of them.
const std::vector<std::byte>& backup_to_restore()
{
    static const std::vector<std::byte> backup = [] {
        storage::MemoryStorage storage;
        NullLog log;
        MachineSettings settings{storage, "server.json", "security.json", "transaction"};
        REQUIRE(settings.transfer(used_at(ports_in_turn[2]), MachineMode::Program));
        const MachineMemory data{storage, "transaction", virtual_machine_items(), log};
        return data.backup({"another"}).value();
    }();
    return backup;
}

/// What the controller said that it has done.
struct Acknowledged {
    std::int16_t counter{1};
    std::size_t port{0}; // of ports_in_turn
    std::size_t lines{0};
};

struct PowerCut {
    explicit PowerCut(SetClock& its_clock) : clock{its_clock}
    {
        MachineSettings settings{medium, "server.json", "security.json", "transaction"};
        REQUIRE(settings.transfer(used_at(ports_in_turn[0]), MachineMode::Program));
        machine = switched_on();
        REQUIRE(machine->scan(1));
        machine->work();
    }

    [[nodiscard]] std::unique_ptr<VirtualMachine> switched_on()
    {
        auto one = std::make_unique<VirtualMachine>(medium, medium, clock, do_at_once);
        one->program = counting_program();
        one->power_on();
        return one;
    }
    [[nodiscard]] std::vector<ExecutionLogEntry> lines()
    {
        const auto contents =
            read_execution_log(medium, ExecutionLogOptions{}.folder, {}, 1'000).value();
        REQUIRE(contents.damaged == 0);
        return contents.entries;
    }
    /// All that is kept is changed, as far as the power allows.
    Acknowledged work_until_dark()
    {
        Acknowledged done;
        done.counter = machine->scan(2) ? 2 : 1;
        machine->download(counting_program(), used_at(ports_in_turn[1]));
        done.port = machine->settings.server().port == ports_in_turn[1] ? 1 : 0;
        machine->work();
        const bool is_halted = machine->life.operating_status() == OperatingStatus::HaltError;
        done.lines = is_halted
                         ? lines_of_start
                         : lines_of_start + lines_of_download - machine->execution_log->waiting();
        done.counter = !is_halted && machine->scan(3) ? std::int16_t{3} : done.counter;
        done.port = machine->restore(backup_to_restore()) ? 2 : done.port;
        return done;
    }

    SetClock& clock;
    storage::MemoryStorage medium;
    std::unique_ptr<VirtualMachine> machine;
};

/// The controller that starts afterwards.
void check_next_start(PowerCut& world, const Acknowledged& acknowledged)
{
    world.machine.reset();
    const auto next = world.switched_on();
    REQUIRE(next->life.operating_status() == OperatingStatus::Running);
    const auto port =
        std::find(ports_in_turn.begin(), ports_in_turn.end(), next->settings.server().port);
    REQUIRE(port - ports_in_turn.begin() >= static_cast<std::ptrdiff_t>(acknowledged.port));
    REQUIRE(next->restored.problems.empty());
    REQUIRE(next->counter() >= acknowledged.counter);
    const std::size_t before = world.lines().size();
    REQUIRE(before >= acknowledged.lines);
    next->work();
    REQUIRE(next->execution_log->waiting() == 0);
    const auto lines = world.lines();
    REQUIRE(lines.size() == before + lines_of_start);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        REQUIRE(lines[i].serial_number == i);
    }
    REQUIRE(lines.back().code->name == "Run");
    REQUIRE(next->event_log->events().back().type->code == 0x95D00000);
    REQUIRE(next->scan(7));
}

} // namespace

TEST_CASE("After a power cut at any byte the controller starts and logs (9-2-2, 35D00000)",
          "[power_cut][machine]")
{
    SetClock clock;
    clock.time = example_start;
    std::size_t old_ones = 0;
    bool is_undisturbed = false;
    const Turns cuts{"machine", 5};
    std::size_t step = cuts.first;
    for (; !is_undisturbed; step += cuts.stride) {
        PowerCut world{clock};
        world.medium.cut_power_after(step);
        const Acknowledged acknowledged = world.work_until_dark();
        is_undisturbed = world.medium.free_space().has_value();
        world.medium.restore_power();
        INFO("power cut after " << step << " steps");
        check_next_start(world, acknowledged);
        old_ones += acknowledged.port == 0 ? cuts.stride : 0U;
    }
    CHECK(old_ones > 100);
    CHECK(step > old_ones + 100);
}

TEST_CASE(
    "With any fault of the medium the controller goes on and loses no record (9-2-2, 15000000)",
    "[power_cut][machine]")
{
    using Fault = std::function<void(storage::MemoryStorage&, bool)>;
    const std::map<std::string, Fault> faults{
        {"0005", [](auto& medium, bool is_on) { medium.set_capacity(is_on ? 0 : UINT64_MAX); }},
        {"0003", [](auto& medium, bool is_on) { medium.set_protected(is_on); }},
        {"0001", [](auto& medium, bool is_on) { medium.set_away(is_on); }},
    };
    SetClock clock;
    clock.time = example_start;
    for (const auto& [code, set] : faults) {
        INFO(code);
        PowerCut world{clock};
        VirtualMachine& machine = *world.machine;
        set(world.medium, true);
        const Acknowledged acknowledged = world.work_until_dark();
        CHECK(acknowledged.counter == 1);
        CHECK(acknowledged.port == 0);
        CHECK(machine.event_log->events().back().attached == Texts{code});
        const std::size_t waiting = machine.execution_log->waiting();
        REQUIRE(waiting > 0);
        set(world.medium, false);
        machine.work();
        CHECK(machine.execution_log->waiting() == 0);
        CHECK(machine.execution_log->lost() == 0);
        CHECK(world.lines().size() == lines_of_start + waiting);
        CHECK_FALSE(machine.event_log->plc_error() == PlcError{EventLevel::MinorFault, 0x15000000});
        REQUIRE(machine.scan(4));
        check_next_start(world, {.counter = 4, .port = 0, .lines = lines_of_start + waiting});
    }
}

} // namespace machine_power_cut_test
