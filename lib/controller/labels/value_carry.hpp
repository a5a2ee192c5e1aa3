#pragma once

#include <cstddef>
#include <vector>

#include <busbar/controller/label_program.hpp>

namespace busbar::controller::detail {

/// Memory of a variable that keeps its value when a program is replaced.
struct CarriedValue {
    const std::byte* from;
    std::byte* to;
    std::size_t size;
};

/// Lists what to copy when `next` replaces `now`: variables with the same name and with types that
/// have the same values.
[[nodiscard]] std::vector<CarriedValue> carried_values(const LabelProgram& now,
                                                       const LabelProgram& next);

} // namespace busbar::controller::detail
