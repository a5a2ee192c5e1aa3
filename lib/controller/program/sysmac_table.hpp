#pragma once

#include <string_view>

#include "program_parts.hpp"

namespace busbar::controller::detail {

/// Tells whether the text is a table of global variables as Sysmac Studio copies it: lines of cells
/// between tabs. The first line, or the second one after a line of titles, has a name, a type, and
/// TRUE or FALSE as its fifth and sixth cell.
[[nodiscard]] BUSBAR_API bool is_sysmac_table(std::string_view text);

/// Adds such a table. The source must outlive the parts.
[[nodiscard]] BUSBAR_API Configured<void> add_sysmac_table(const SourceText& source,
                                                           ProgramParts& to);

} // namespace busbar::controller::detail
