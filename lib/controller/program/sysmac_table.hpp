#pragma once

#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// Tells whether the text is a table of global variables as Sysmac Studio copies it: lines of 8
/// cells between tabs, with True or False in the fifth and the sixth.
[[nodiscard]] BUSBAR_API bool is_sysmac_table(std::string_view text);

/// Reads such a table, with or without a line of titles: name, type, initial value, AT, Retain,
/// Constant, Network Publish and comment. Problems have the places of the cells. The text is UTF-8.
[[nodiscard]] BUSBAR_API Configured<Program> read_sysmac_table(std::string_view text,
                                                               std::string_view file_name,
                                                               const DeclarationLimits& limits,
                                                               Unserved unserved);

} // namespace busbar::controller::detail
