#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <busbar/controller/life_cycle.hpp>
#include <busbar/controller/machine_status.hpp>
#include <busbar/core/record.hpp>

/// The life of a controller and its server as tables (W588, 4-1, 4-2-4 and 9-1-2): the states,
/// where each cause leads, and the records written to the logs, which get no others.
namespace busbar::controller::detail {

enum class LifePhase : std::uint8_t {
    NotStarted,
    Initializing,
    Preparing,
    Waiting, // for the end of a download, a restore or a clearing
    Running,
    Halted,    // a download repairs it
    Broken,    // only a restart repairs it
    Stopping,  // waits for the answer to stop()
    Resetting, // the same, followed by a new start
    Stopped,
};

enum class LifeEvent : std::uint8_t {
    Restart, // power or a reset
    Used,    // settings were read that use the server
    Unused,
    Unreadable,
    Begins, // a download, a restore, a clearing
    Replaced,
    Kept,
    Changed, // the contents of the server
    Edited,  // online
    Prepared,
    StartFailed,
    SystemFailed,
    ShutDown,
    Watchdog,
    Stopped,
    // Faults that are not the server's, or do not stop it.
    MajorFault,
    PartialFault,
    MinorFault,
};

enum class LifeAction : std::uint8_t {
    None,
    Initialize,
    Prepare,
    Reconfigure,
    Run,
    Suspend,
    Stop,
    AddVariables,
};

struct PhaseFacts {
    LifePhase phase;
    OperatingStatus status;
    ServedClients serves;
    bool is_restart_due;
};

inline constexpr std::array phase_facts{
    PhaseFacts{LifePhase::NotStarted, OperatingStatus::NotStarted, ServedClients::None, false},
    PhaseFacts{LifePhase::Initializing, OperatingStatus::Initializing, ServedClients::None, false},
    PhaseFacts{LifePhase::Preparing, OperatingStatus::Preparing, ServedClients::None, false},
    PhaseFacts{LifePhase::Waiting, OperatingStatus::Preparing, ServedClients::None, false},
    PhaseFacts{LifePhase::Running, OperatingStatus::Running, ServedClients::All, false},
    PhaseFacts{LifePhase::Halted, OperatingStatus::HaltError, ServedClients::Administrators, false},
    PhaseFacts{LifePhase::Broken, OperatingStatus::HaltError, ServedClients::Administrators, true},
    PhaseFacts{LifePhase::Stopping, OperatingStatus::Shutdown, ServedClients::Administrators, true},
    PhaseFacts{LifePhase::Resetting, OperatingStatus::Shutdown, ServedClients::None, true},
    PhaseFacts{LifePhase::Stopped, OperatingStatus::Shutdown, ServedClients::Administrators, true},
};

[[nodiscard]] constexpr const PhaseFacts& facts_of(LifePhase phase)
{
    return phase_facts[static_cast<std::size_t>(phase)];
}

/// The effect of a cause on the controller besides its server, in any state.
struct CauseFacts {
    LifeEvent event;
    /// Whether the user program continues, stops or starts.
    enum class Program : std::uint8_t { GoesOn, Stops, Starts } program;
    /// The level of the event to record; empty for none.
    std::string_view fault{};
};

/// Causes that are not listed have no effect besides their step.
inline constexpr std::array cause_facts{
    CauseFacts{LifeEvent::Restart, CauseFacts::Program::Starts},
    CauseFacts{LifeEvent::Watchdog, CauseFacts::Program::Stops, "Major fault"},
    CauseFacts{LifeEvent::MajorFault, CauseFacts::Program::Stops, "Major fault"},
    CauseFacts{LifeEvent::PartialFault, CauseFacts::Program::GoesOn, "Partial fault"},
    CauseFacts{LifeEvent::MinorFault, CauseFacts::Program::GoesOn, "Minor fault"},
};

[[nodiscard]] constexpr CauseFacts facts_of(LifeEvent event)
{
    for (const CauseFacts& each : cause_facts) {
        if (each.event == event) {
            return each;
        }
    }
    return {event, CauseFacts::Program::GoesOn};
}

/// The records that a step writes, as bits, in this order.
namespace told {
inline constexpr std::uint8_t nothing = 0;
inline constexpr std::uint8_t shut_down = 1;
inline constexpr std::uint8_t system_error = 2;
inline constexpr std::uint8_t halted = 4;
inline constexpr std::uint8_t started = 8;
inline constexpr std::uint8_t preparing = 16;
inline constexpr std::uint8_t running = 32;
} // namespace told

struct ToldRecord {
    std::uint8_t bit;
    RecordKind kind;
};
inline constexpr std::array told_records{
    ToldRecord{told::shut_down, RecordKind::ServerShutDown},
    ToldRecord{told::system_error, RecordKind::ServerSystemError},
    ToldRecord{told::halted, RecordKind::ServerHalted},
    ToldRecord{told::started, RecordKind::ServerStarted},
    ToldRecord{told::preparing, RecordKind::ServerPreparing},
    ToldRecord{told::running, RecordKind::ServerRunning},
};

struct LifeStep {
    LifePhase phase;
    LifeEvent event;
    LifePhase next;
    LifeAction action;
    std::uint8_t records{told::nothing};
};

/// Combinations that are not listed leave the server as it is.
inline constexpr std::array life_steps{
    LifeStep{LifePhase::NotStarted, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},

    LifeStep{LifePhase::Initializing, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
    LifeStep{LifePhase::Initializing, LifeEvent::Used, LifePhase::Preparing, LifeAction::Prepare,
             told::started | told::preparing},
    LifeStep{LifePhase::Initializing, LifeEvent::Unused, LifePhase::NotStarted, LifeAction::None},
    LifeStep{LifePhase::Initializing, LifeEvent::Unreadable, LifePhase::Halted, LifeAction::None,
             told::halted},
    LifeStep{LifePhase::Initializing, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop,
             told::system_error | told::halted},
    LifeStep{LifePhase::Initializing, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Preparing, LifeEvent::Restart, LifePhase::Resetting, LifeAction::Stop},
    LifeStep{LifePhase::Preparing, LifeEvent::Begins, LifePhase::Waiting, LifeAction::Suspend},
    LifeStep{LifePhase::Preparing, LifeEvent::Changed, LifePhase::Preparing, LifeAction::Prepare,
             told::preparing},
    LifeStep{LifePhase::Preparing, LifeEvent::Prepared, LifePhase::Running, LifeAction::Run,
             told::running},
    LifeStep{LifePhase::Preparing, LifeEvent::StartFailed, LifePhase::Halted, LifeAction::Stop,
             told::halted},
    LifeStep{LifePhase::Preparing, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop,
             told::system_error | told::halted},
    LifeStep{LifePhase::Preparing, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Preparing, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Waiting, LifeEvent::Restart, LifePhase::Resetting, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Used, LifePhase::Preparing, LifeAction::Prepare,
             told::preparing},
    LifeStep{LifePhase::Waiting, LifeEvent::Unused, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Unreadable, LifePhase::Halted, LifeAction::Stop,
             told::halted},
    LifeStep{LifePhase::Waiting, LifeEvent::Replaced, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Kept, LifePhase::Preparing, LifeAction::Prepare,
             told::preparing},
    LifeStep{LifePhase::Waiting, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop,
             told::system_error | told::halted},
    LifeStep{LifePhase::Waiting, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Running, LifeEvent::Restart, LifePhase::Resetting, LifeAction::Stop},
    LifeStep{LifePhase::Running, LifeEvent::Begins, LifePhase::Waiting, LifeAction::Suspend},
    LifeStep{LifePhase::Running, LifeEvent::Changed, LifePhase::Preparing, LifeAction::Reconfigure,
             told::preparing},
    LifeStep{LifePhase::Running, LifeEvent::Edited, LifePhase::Running, LifeAction::AddVariables},
    LifeStep{LifePhase::Running, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop,
             told::system_error | told::halted},
    LifeStep{LifePhase::Running, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Running, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Halted, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
    LifeStep{LifePhase::Halted, LifeEvent::Used, LifePhase::Preparing, LifeAction::Prepare,
             told::preparing},
    LifeStep{LifePhase::Halted, LifeEvent::Unused, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Halted, LifeEvent::Unreadable, LifePhase::Halted, LifeAction::None,
             told::halted},
    LifeStep{LifePhase::Halted, LifeEvent::Replaced, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Halted, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::None,
             told::system_error | told::halted},
    LifeStep{LifePhase::Halted, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Halted, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Broken, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
    LifeStep{LifePhase::Broken, LifeEvent::Replaced, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Broken, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Broken, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Stopping, LifeEvent::Restart, LifePhase::Resetting, LifeAction::None},
    LifeStep{LifePhase::Stopping, LifeEvent::Stopped, LifePhase::Stopped, LifeAction::None,
             told::shut_down},

    LifeStep{LifePhase::Resetting, LifeEvent::Stopped, LifePhase::Initializing,
             LifeAction::Initialize, told::shut_down},

    LifeStep{LifePhase::Stopped, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
};

/// Null if nothing has to be done.
[[nodiscard]] constexpr const LifeStep* life_step(LifePhase phase, LifeEvent event)
{
    for (const LifeStep& step : life_steps) {
        if (step.phase == phase && step.event == event) {
            return &step;
        }
    }
    return nullptr;
}

static_assert([] {
    for (std::size_t i = 0; i < phase_facts.size(); ++i) {
        if (phase_facts[i].phase != static_cast<LifePhase>(i)) {
            return false;
        }
    }
    return phase_facts.size() == static_cast<std::size_t>(LifePhase::Stopped) + 1;
}());

} // namespace busbar::controller::detail
