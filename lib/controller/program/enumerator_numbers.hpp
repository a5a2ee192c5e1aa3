#pragma once

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// Gives initial values the form that their types need: a number for the name of a value of an
/// enumeration where the type is a number (`n : INT := Color.Red`), and the name for a number where
/// the type is an enumeration that has one of this number. Leaves other values to the checks of
/// CheckedProgram, which the program has not passed yet.
BUSBAR_API void settle_enumerators(Program& program);

} // namespace busbar::controller::detail
