#pragma once

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Makes each WSTRING[n] of a program an array of n + 1 UTF16_UNIT, which is what a text of a label
/// is (SH-082679, 8.2), and its initial values those of the elements. Returns false, with nothing
/// changed, if there is none; a problem if the initial values have more than 1 MiB of text, of
/// which each character becomes a value. `types` are those of the program, which has label_types()
/// and passed check_initial_values(); they are not valid afterwards.
[[nodiscard]] Configured<bool> lay_out_wide_texts(Program& program, const ProgramTypes& types);

} // namespace busbar::controller::detail
