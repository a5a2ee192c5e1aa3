#pragma once

#include <busbar/controller/program_types.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller::detail {

/// Whether those types and variables of `edited` that are in `before` too are what they are there:
/// what is published of them already stays (seed 000, 4-2-5). Initial values, RETAIN, the publish
/// attribute and comments may be others. The problem is about `edited`.
[[nodiscard]] Configured<void> check_unchanged(const ProgramTypes& before,
                                               const ProgramTypes& edited);

} // namespace busbar::controller::detail
