#pragma once

#include <busbar/controller/program.hpp>

namespace busbar::product {

/// Whether `edited` has everything that `before` has, so that an online edit may do (seed 000,
/// 4-2-5): all variables, by their names, and the same tasks and instances. Whether they are what
/// they were is for PublishedProgram::add to say.
[[nodiscard]] bool keeps_all(const controller::Program& before, const controller::Program& edited);

} // namespace busbar::product
