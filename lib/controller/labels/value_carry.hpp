#pragma once

#include <cstddef>
#include <vector>

#include <busbar/controller/label_program.hpp>

namespace busbar::controller::detail {

/// Memory of a variable that stays when a program is replaced.
struct CarriedValue {
    const std::byte* from;
    std::byte* to;
    std::size_t size;
};

/// What is to be copied when `next` takes the place of `now`: variables with the same name and a
/// type with the same values.
[[nodiscard]] std::vector<CarriedValue> carried_values(const LabelProgram& now,
                                                       const LabelProgram& next);

} // namespace busbar::controller::detail
