#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller::detail {

/// Quotes a name of any length and content for a message.
[[nodiscard]] std::string quoted_name(const std::string& name);

/// Names an element of a list: "variables[7] (Speed)".
[[nodiscard]] std::string place_in(std::string_view list, std::size_t index,
                                   const std::string& name);

/// Makes a problem with line and column if the place is known.
[[nodiscard]] Problem problem_at(std::string where, const ProgramPlace& place, std::string text);

/// Makes the note about a declaration that is left out because of a problem at this place. A Part
/// has no name.
[[nodiscard]] BUSBAR_API LeftOut left_out(LeftOut::Kind kind, std::string name,
                                          NetworkPublish publish, const ProgramPlace& place,
                                          const std::string& text);

} // namespace busbar::controller::detail
