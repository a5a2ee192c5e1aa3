#pragma once

#include <busbar/controller/program_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// Checks whether the initial values of types, members and variables fit their types: numbers
/// within the range and the subrange, texts of UTF-8 no longer than the STRING, existing
/// enumerators and members, each member once, no more elements than the array has, one member of a
/// union. The first problem's `where` is "variables[7] (Speed)", followed by the part within it
/// (".Limits[3]"), and preceded by line and column if these are known.
[[nodiscard]] BUSBAR_API Configured<void> check_initial_values(const ProgramTypes& types);

} // namespace busbar::controller
