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

/// What a program is changed against: what runs, as nothing else may be looked at in another thread
/// than the server's.
struct ProgramBase {
    /// See PublishedProgram.
    std::vector<controller::PublishedProgram::Edition> editions;
    /// Of the configuration in force.
    PlcTrial trial;
};

/// Whether an online edit makes the last edition to this program (W588, 3-3-2). Any thread.
[[nodiscard]] Configured<void>
check_edit(std::span<const controller::PublishedProgram::Edition> editions,
           const controller::CheckedProgram& edited);

/// A program as it was prepared in another thread.
struct PreparedProgram {
    SourceFiles::Prepared files;
    /// Which check_edit() was asked about, and what it said.
    controller::PublishedProgram::Edition edition;
    Configured<void> may_edit;
};

/// Reads and checks the program, and tries its PLC. The problem is that of read_program(); a PLC
/// that is not possible is left for who knows what to call it. Any thread.
[[nodiscard]] Configured<PreparedProgram>
prepare_program(const ProgramBase& base, std::string_view text, const std::string& name);

/// One declaration of two programs, as each has it; empty: it has none of the name.
struct ProgramDifference {
    /// "variable Speed", "type Point", "task Main", "instance Main".
    std::string what;
    std::string file;
    std::string controller;
};

/// What differs between the program of a file and a controller's, but for comments and places.
[[nodiscard]] std::vector<ProgramDifference> differences(const controller::Program& file,
                                                         const controller::Program& controller);

} // namespace busbar::product
