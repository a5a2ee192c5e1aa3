#pragma once

#include <cstdlib>
#include <utility>

#include <busbar/controller/checked_program.hpp>
#include <busbar/controller/program_initial.hpp>
#include <busbar/core/text.hpp>

/// A problem says where and what, in printable text; a program is checked like any other.
inline void check_problem(const busbar::Problem& problem)
{
    if (problem.where.empty() || problem.text.empty() ||
        busbar::printable(problem.text, problem.text.size() * 4) != problem.text) {
        std::abort();
    }
}

/// A program that leaves out what it does not serve can be served: a fuzzed text is too small for
/// too many types or variables.
inline void check_left_out(busbar::Configured<busbar::controller::Program> program)
{
    using namespace busbar::controller;
    if (!program) {
        check_problem(program.error());
        return;
    }
    const auto checked = CheckedProgram::create(std::move(*program), Unserved::LeaveOut);
    if (!checked) {
        std::abort();
    }
    for (const LeftOut& each : (*checked)->program().left_out) {
        check_problem(each.problem);
    }
}

inline void check_program(const busbar::Configured<busbar::controller::Program>& program)
{
    using namespace busbar::controller;
    if (!program) {
        check_problem(program.error());
        return;
    }
    const auto types = ProgramTypes::create(*program);
    if (!types) {
        check_problem(types.error());
        return;
    }
    if (const auto checked = check_initial_values(*types); !checked) {
        check_problem(checked.error());
    }
}
