#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/program.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/core/problem.hpp>

#include "product/configuration/plc_trial.hpp"
#include "product/store/source_files.hpp"

namespace busbar::product {

/// The base of a program's change: a copy of what runs, since only the server's thread may look at
/// anything else.
struct ProgramBase {
    /// See PublishedProgram.
    std::vector<controller::PublishedProgram::Edition> editions;
    /// Taken from the configuration in force.
    PlcTrial trial;
    /// Whether the next program may leave out more than the last edition; see check_left_out().
    bool may_leave_out_more{false};
};

/// Tells whether an online edit can change the last edition into this program (W588, 3-3-2).
/// Thread-safe.
[[nodiscard]] Configured<void>
check_edit(std::span<const controller::PublishedProgram::Edition> editions,
           const controller::CheckedProgram& edited);

/// Refuses a program that leaves out a declaration which the one before it served or lacked: what
/// clients see of a machine does not become less by a mistake in a file. Thread-safe.
[[nodiscard]] Configured<void> check_left_out(const controller::Program& before,
                                              const controller::Program& next,
                                              const std::string& file);

/// A program that was prepared on another thread.
struct PreparedProgram {
    SourceFiles::Prepared files;
    /// The edition that check_edit() was called for, and its result.
    controller::PublishedProgram::Edition edition;
    Configured<void> may_edit;
};

/// Reads and checks the program, and tries its PLC. Fails like read_program() and, unless the base
/// allows it, check_left_out(); an impossible PLC is
/// reported by a caller that knows its name. Thread-safe.
[[nodiscard]] Configured<PreparedProgram>
prepare_program(const ProgramBase& base, std::string_view text, const std::string& name);

/// One declaration in two programs; empty where a program lacks it.
struct ProgramDifference {
    /// "variable Speed", "type Point", "task Main", "instance Main".
    std::string what;
    std::string file;
    std::string controller;
};

/// The differences between a file's program and a controller's, ignoring comments and places.
[[nodiscard]] std::vector<ProgramDifference> differences(const controller::Program& file,
                                                         const controller::Program& controller);

} // namespace busbar::product
