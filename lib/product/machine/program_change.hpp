#pragma once

#include <string>
#include <vector>

#include <busbar/controller/program.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// Whether both have the same tasks and instances, which an online edit does not change (seed 000,
/// 3-3-2). The problem is the first one that is new, gone or another one.
[[nodiscard]] Configured<void> check_same_tasks(const controller::Program& before,
                                                const controller::Program& edited);

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
