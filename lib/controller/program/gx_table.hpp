#pragma once

#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// Tells whether the text is a list of global labels as GX Works2 and GX Works3 export it: one of
/// the first lines has the titles of the name and of the data type, in English or Japanese.
[[nodiscard]] BUSBAR_API bool is_gx_table(std::string_view text);

/// Reads such a list. Problems have the place of the label's line. The text is UTF-8.
[[nodiscard]] BUSBAR_API Configured<Program> read_gx_table(std::string_view text,
                                                           std::string_view file_name,
                                                           const DeclarationLimits& limits,
                                                           Unserved unserved);

} // namespace busbar::controller::detail
