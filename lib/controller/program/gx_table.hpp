#pragma once

#include <string_view>

#include "program_parts.hpp"

namespace busbar::controller::detail {

/// Tells whether the text is a list of global labels, or of a structure's members, as GX Works2 and
/// GX Works3 export it: one of the first lines has the titles of the name and of the data type, in
/// English or Japanese.
[[nodiscard]] BUSBAR_API bool is_gx_table(std::string_view text);

/// Adds such a list. The source must outlive the parts.
[[nodiscard]] BUSBAR_API Configured<void> add_gx_table(const SourceText& source, ProgramParts& to);

} // namespace busbar::controller::detail
