#pragma once

#include <busbar/controller/program_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// Whether the initial values of types, members and variables are of their types: numbers within
/// the range and the subrange, texts of UTF-8 no longer than the STRING, enumerators and members
/// that there are, each member once, no more elements than the array has, one member of a union.
/// The first problem's `where` is "variables[7] (Speed)", with what is within it behind that
/// (".Limits[3]"), and before it line and column where these are known.
[[nodiscard]] BUSBAR_API Configured<void> check_initial_values(const ProgramTypes& types);

} // namespace busbar::controller
