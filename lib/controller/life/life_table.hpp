#pragma once

#include <array>
#include <cstdint>

/// The life of the server as a table (seed 000, 4-1 and 4-2-4).
namespace busbar::controller::detail {

enum class LifePhase : std::uint8_t {
    NotStarted,
    Initializing,
    Preparing,
    Waiting, // for the end of a download, a restore or a clearing
    Running,
    Halted,    // a download mends it
    Broken,    // it takes a restart
    Stopping,  // stop() is to be answered
    Resetting, // the same, and then all begins again
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
    Changed, // what the server is made of
    Edited,  // online
    Prepared,
    StartFailed,
    SystemFailed,
    ShutDown,
    Watchdog,
    Stopped,
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

struct LifeStep {
    LifePhase phase;
    LifeEvent event;
    LifePhase next;
    LifeAction action;
};

/// What is not here changes nothing.
inline constexpr std::array life_steps{
    LifeStep{LifePhase::NotStarted, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},

    LifeStep{LifePhase::Initializing, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
    LifeStep{LifePhase::Initializing, LifeEvent::Used, LifePhase::Preparing, LifeAction::Prepare},
    LifeStep{LifePhase::Initializing, LifeEvent::Unused, LifePhase::NotStarted, LifeAction::None},
    LifeStep{LifePhase::Initializing, LifeEvent::Unreadable, LifePhase::Halted, LifeAction::None},
    LifeStep{LifePhase::Initializing, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop},
    LifeStep{LifePhase::Initializing, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Preparing, LifeEvent::Restart, LifePhase::Resetting, LifeAction::Stop},
    LifeStep{LifePhase::Preparing, LifeEvent::Begins, LifePhase::Waiting, LifeAction::Suspend},
    LifeStep{LifePhase::Preparing, LifeEvent::Changed, LifePhase::Preparing, LifeAction::Prepare},
    LifeStep{LifePhase::Preparing, LifeEvent::Prepared, LifePhase::Running, LifeAction::Run},
    LifeStep{LifePhase::Preparing, LifeEvent::StartFailed, LifePhase::Halted, LifeAction::Stop},
    LifeStep{LifePhase::Preparing, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop},
    LifeStep{LifePhase::Preparing, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Preparing, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Waiting, LifeEvent::Restart, LifePhase::Resetting, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Used, LifePhase::Preparing, LifeAction::Prepare},
    LifeStep{LifePhase::Waiting, LifeEvent::Unused, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Unreadable, LifePhase::Halted, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Replaced, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Kept, LifePhase::Preparing, LifeAction::Prepare},
    LifeStep{LifePhase::Waiting, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Waiting, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Running, LifeEvent::Restart, LifePhase::Resetting, LifeAction::Stop},
    LifeStep{LifePhase::Running, LifeEvent::Begins, LifePhase::Waiting, LifeAction::Suspend},
    LifeStep{LifePhase::Running, LifeEvent::Changed, LifePhase::Preparing, LifeAction::Reconfigure},
    LifeStep{LifePhase::Running, LifeEvent::Edited, LifePhase::Running, LifeAction::AddVariables},
    LifeStep{LifePhase::Running, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::Stop},
    LifeStep{LifePhase::Running, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Running, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Halted, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
    LifeStep{LifePhase::Halted, LifeEvent::Used, LifePhase::Preparing, LifeAction::Prepare},
    LifeStep{LifePhase::Halted, LifeEvent::Unused, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Halted, LifeEvent::Unreadable, LifePhase::Halted, LifeAction::None},
    LifeStep{LifePhase::Halted, LifeEvent::Replaced, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Halted, LifeEvent::SystemFailed, LifePhase::Broken, LifeAction::None},
    LifeStep{LifePhase::Halted, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Halted, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Broken, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
    LifeStep{LifePhase::Broken, LifeEvent::Replaced, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Broken, LifeEvent::ShutDown, LifePhase::Stopping, LifeAction::Stop},
    LifeStep{LifePhase::Broken, LifeEvent::Watchdog, LifePhase::Stopping, LifeAction::Stop},

    LifeStep{LifePhase::Stopping, LifeEvent::Restart, LifePhase::Resetting, LifeAction::None},
    LifeStep{LifePhase::Stopping, LifeEvent::Stopped, LifePhase::Stopped, LifeAction::None},

    LifeStep{LifePhase::Resetting, LifeEvent::Stopped, LifePhase::Initializing,
             LifeAction::Initialize},

    LifeStep{LifePhase::Stopped, LifeEvent::Restart, LifePhase::Initializing,
             LifeAction::Initialize},
};

/// Null if nothing is to be done.
[[nodiscard]] constexpr const LifeStep* life_step(LifePhase phase, LifeEvent event)
{
    for (const LifeStep& step : life_steps) {
        if (step.phase == phase && step.event == event) {
            return &step;
        }
    }
    return nullptr;
}

} // namespace busbar::controller::detail
