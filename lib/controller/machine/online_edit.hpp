#pragma once

#include <busbar/controller/checked_program.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller::detail {

// Whether what of `edited` is in `before` too is what it is there: the nodes of DataTypes stay, and
// a variable that stays keeps its node and its place in the image (W588, 3-3-2 and 4-2-5).
// Problems are about `edited`.

/// No type is another one.
[[nodiscard]] Configured<void> check_same_types(const ProgramTypes& before,
                                                const ProgramTypes& edited);
/// No variable has another type, or is a constant and was none. Initial values, RETAIN, the publish
/// attribute, addresses and comments may be others.
[[nodiscard]] Configured<void> check_same_variables(const CheckedProgram& before,
                                                    const CheckedProgram& edited);

} // namespace busbar::controller::detail
