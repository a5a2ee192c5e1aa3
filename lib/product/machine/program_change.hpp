#pragma once

#include <busbar/controller/program.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::product {

/// Whether both have the same tasks and instances, which an online edit does not change (seed 000,
/// 3-3-2). The problem is the first one that is new, gone or another one.
[[nodiscard]] Configured<void> check_same_tasks(const controller::Program& before,
                                                const controller::Program& edited);

} // namespace busbar::product
