#pragma once

#include <string>
#include <vector>

#include <busbar/core/expected.hpp>

#include "appendix7.hpp"
#include "churn.hpp"
#include "growth.hpp"
#include "hostile.hpp"
#include "load.hpp"
#include "publishes.hpp"
#include "session_memory.hpp"
#include "startup_run.hpp"

namespace busbar::bench {

/// What one run of the program measures.
enum class Command {
    Loads,
    Compare,
    Memory,
    Hostile,
    Churn,
    Growth,
    Startup,
    Appendix7,
    Publishes,
};

/// The words behind the program's name. Commands that they do not name have their defaults.
struct CommandLine {
    Command command{Command::Loads};
    /// And thus a server that somebody else has started.
    bool has_url{false};
    Options loads;
    HostileOptions hostile;
    ChurnOptions churn;
    GrowthOptions growth;
    SessionMemoryOptions memory;
    StartupOptions startup;
    SevenOptions seven;
    PublishesOptions publishes;
    /// Two files, before and after.
    std::vector<std::string> compared;
};

/// The error is the exit code of a program that has nothing more to do: the words are wrong, which
/// was said, or it was asked for help.
[[nodiscard]] Expected<CommandLine, int> read_command_line(int argc, char** argv);

} // namespace busbar::bench
