#pragma once

#include <string_view>

#include "controller/program/declaration_parts.hpp"

namespace busbar::controller::detail {

/// Reads the declarations in a file of TwinCAT: .TcGVL, .TcDUT, .TcPOU and .TcIO, a <TcPlcObject>
/// whose objects have a <Declaration> with a text. Problems have the places in the file. The text
/// is UTF-8.
[[nodiscard]] Configured<Program> read_twincat(std::string_view text, std::string_view file_name,
                                               const DeclarationLimits& limits, Unserved unserved);

} // namespace busbar::controller::detail
