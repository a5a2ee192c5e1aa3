#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <controller/life/life_table.hpp>

namespace life_table_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::detail;

namespace {

bool has(LifePhase phase, LifeEvent event)
{
    return life_step(phase, event) != nullptr;
}

constexpr auto last_phase = static_cast<int>(LifePhase::Stopped);

/// In the order of LifePhase.
constexpr std::array<std::string_view, 10> phase_names{
    "NotStarted", "Initializing", "Preparing", "Waiting",   "Running",
    "Halted",     "Broken",       "Stopping",  "Resetting", "Stopped"};
/// In the order of LifeEvent.
constexpr std::array<std::string_view, 18> event_names{
    "Restart",  "Used",     "Unused",  "Unreadable", "Begins",       "Replaced",
    "Kept",     "Changed",  "Edited",  "Prepared",   "StartFailed",  "SystemFailed",
    "ShutDown", "Watchdog", "Stopped", "MajorFault", "PartialFault", "MinorFault"};

/// Log codes of the execution log (7-1-6): Start, Shutdown, HaltError, Prepare, Run.
std::string codes_of(std::uint8_t records)
{
    std::string codes;
    for (const auto& [bit, code] : {std::pair{told::shut_down, "0006"},
                                    {told::halted, "0007"},
                                    {told::started, "0001"},
                                    {told::preparing, "0004"},
                                    {told::running, "0005"}}) {
        codes += (records & bit) != 0 ? (codes.empty() ? ", " : " ") + std::string{code} : "";
    }
    return codes;
}

/// All that leads from one state to another: 4-1-1 (start and stop), 4-1-2 (what only a restart
/// mends), 4-1-3 and 4-1-4 (what stops the server), 4-2-4 (states) and 4-2-5 (Changed, Edited).
const std::vector<std::string> steps_of_manual{
    "NotStarted Restart: Initializing",
    "Initializing Restart: Initializing",
    "Initializing Used: Preparing, 0001 0004",
    "Initializing Unused: NotStarted",
    "Initializing Unreadable: Halted, 0007",
    "Initializing SystemFailed: Broken, 0007",
    "Initializing Watchdog: Stopping",
    "Preparing Restart: Resetting",
    "Preparing Begins: Waiting",
    "Preparing Changed: Preparing, 0004",
    "Preparing Prepared: Running, 0005",
    "Preparing StartFailed: Halted, 0007",
    "Preparing SystemFailed: Broken, 0007",
    "Preparing ShutDown: Stopping",
    "Preparing Watchdog: Stopping",
    "Waiting Restart: Resetting",
    "Waiting Used: Preparing, 0004",
    "Waiting Unused: Stopping",
    "Waiting Unreadable: Halted, 0007",
    "Waiting Replaced: Stopping",
    "Waiting Kept: Preparing, 0004",
    "Waiting SystemFailed: Broken, 0007",
    "Waiting ShutDown: Stopping",
    "Waiting Watchdog: Stopping",
    "Running Restart: Resetting",
    "Running Begins: Waiting",
    "Running Changed: Preparing, 0004",
    "Running Edited: Running",
    "Running SystemFailed: Broken, 0007",
    "Running ShutDown: Stopping",
    "Running Watchdog: Stopping",
    "Halted Restart: Initializing",
    "Halted Used: Preparing, 0004",
    "Halted Unused: Stopping",
    "Halted Unreadable: Halted, 0007",
    "Halted Replaced: Stopping",
    "Halted SystemFailed: Broken, 0007",
    "Halted ShutDown: Stopping",
    "Halted Watchdog: Stopping",
    "Broken Restart: Initializing",
    "Broken Replaced: Stopping",
    "Broken ShutDown: Stopping",
    "Broken Watchdog: Stopping",
    "Stopping Restart: Resetting",
    "Stopping Stopped: Stopped, 0006",
    "Resetting Stopped: Initializing, 0006",
    "Stopped Restart: Initializing",
};

} // namespace

TEST_CASE("The states and their causes are those of the manual (4-1, 4-2)")
{
    std::vector<std::string> steps;
    for (std::size_t phase = 0; phase < phase_names.size(); ++phase) {
        for (std::size_t event = 0; event < event_names.size(); ++event) {
            const LifeStep* const step =
                life_step(static_cast<LifePhase>(phase), static_cast<LifeEvent>(event));
            if (step != nullptr) {
                steps.push_back(std::string{phase_names[phase]} + " " +
                                std::string{event_names[event]} + ": " +
                                std::string{phase_names[static_cast<std::size_t>(step->next)]} +
                                codes_of(step->records));
            }
        }
    }
    CHECK(steps == steps_of_manual);
}

TEST_CASE("A state says who is let in and whether it takes a restart (4-1-2, 4-1-4, 4-2-4)")
{
    struct Row {
        LifePhase phase;
        std::string_view status;
        ServedClients serves;
        bool is_restart_due;
    };
    constexpr auto none = ServedClients::None;
    constexpr auto administrators = ServedClients::Administrators;
    const std::vector<Row> rows{{LifePhase::NotStarted, "---", none, false},
                                {LifePhase::Initializing, "Initializing", none, false},
                                {LifePhase::Preparing, "Preparing", none, false},
                                {LifePhase::Waiting, "Preparing", none, false},
                                {LifePhase::Running, "Running", ServedClients::All, false},
                                {LifePhase::Halted, "Halt error", administrators, false},
                                {LifePhase::Broken, "Halt error", administrators, true},
                                {LifePhase::Stopping, "Shutdown", administrators, true},
                                {LifePhase::Resetting, "Shutdown", none, true},
                                {LifePhase::Stopped, "Shutdown", administrators, true}};
    REQUIRE(rows.size() == phase_facts.size());
    for (const Row& row : rows) {
        const PhaseFacts& facts = facts_of(row.phase);
        INFO(row.status);
        CHECK(text(facts.status) == row.status);
        CHECK(facts.serves == row.serves);
        CHECK(facts.is_restart_due == row.is_restart_due);
    }
}

TEST_CASE("The user program stops at major faults only and starts with the controller (9-1-2)")
{
    for (std::size_t i = 0; i < event_names.size(); ++i) {
        const auto event = static_cast<LifeEvent>(i);
        const bool stops = event == LifeEvent::MajorFault || event == LifeEvent::Watchdog;
        INFO(event_names[i]);
        CHECK((facts_of(event).program == CauseFacts::Program::Stops) == stops);
        CHECK((facts_of(event).program == CauseFacts::Program::Starts) ==
              (event == LifeEvent::Restart));
        const std::string_view fault = stops                              ? "Major fault"
                                       : event == LifeEvent::PartialFault ? "Partial fault"
                                       : event == LifeEvent::MinorFault   ? "Minor fault"
                                                                          : "";
        CHECK(facts_of(event).fault == fault);
    }
}

TEST_CASE("A fault that is not the server's leaves every state as it is (4-1-4)")
{
    for (int phase = 0; phase <= last_phase; ++phase) {
        for (const LifeEvent event :
             {LifeEvent::MajorFault, LifeEvent::PartialFault, LifeEvent::MinorFault}) {
            CHECK_FALSE(has(static_cast<LifePhase>(phase), event));
        }
    }
}

TEST_CASE("Each event of a state leads to one other (4-2-4)")
{
    for (const LifeStep& step : life_steps) {
        CHECK(std::count_if(life_steps.begin(), life_steps.end(), [&](const LifeStep& other) {
                  return other.phase == step.phase && other.event == step.event;
              }) == 1);
    }
}

TEST_CASE("Power and a reset are possible in every state (4-1-1)")
{
    for (int phase = 0; phase <= last_phase; ++phase) {
        // It has begun already.
        if (static_cast<LifePhase>(phase) != LifePhase::Resetting) {
            CHECK(has(static_cast<LifePhase>(phase), LifeEvent::Restart));
        }
    }
}

TEST_CASE("No state lets clients in but Running (4-2-4)")
{
    for (const LifeStep& step : life_steps) {
        CHECK((step.action == LifeAction::Run) ==
              (step.next == LifePhase::Running && step.phase != LifePhase::Running));
        const bool leaves = step.phase == LifePhase::Running && step.next != LifePhase::Running;
        CHECK((!leaves || step.action == LifeAction::Stop || step.action == LifeAction::Suspend ||
               step.action == LifeAction::Reconfigure));
    }
}

TEST_CASE("What is shut down comes back by a restart only (4-1-2)")
{
    for (const LifeStep& step : life_steps) {
        if (step.phase == LifePhase::Stopped || step.phase == LifePhase::NotStarted ||
            step.phase == LifePhase::Broken) {
            const bool restarts = step.event == LifeEvent::Restart;
            CHECK(restarts == (step.next == LifePhase::Initializing));
        }
    }
}

} // namespace life_table_test
