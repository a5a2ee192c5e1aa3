#pragma once

#include <busbar/controller/checked_program.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller::detail {

// Check that everything in both programs is the same in `edited` as in `before`: nodes of DataTypes
// stay, and a variable that stays keeps its node and its place in the image (W588, 3-3-2 and
// 4-2-5). Problems refer to `edited`.

/// Checks that no type has changed.
[[nodiscard]] Configured<void> check_same_types(const ProgramTypes& before,
                                                const ProgramTypes& edited);
/// Checks that no variable has changed its type or has become a constant or ceased to be one.
/// Initial values, RETAIN, the publish attribute, addresses and comments may change.
[[nodiscard]] Configured<void> check_same_variables(const CheckedProgram& before,
                                                    const CheckedProgram& edited);

} // namespace busbar::controller::detail
