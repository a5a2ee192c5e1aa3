#pragma once

#include "controller/program/program_parts.hpp"

namespace busbar::controller::detail {

/// Adds the declarations in a file of TwinCAT: .TcGVL, .TcDUT, .TcPOU and .TcIO, a <TcPlcObject>
/// whose objects have a <Declaration> with a text. Problems have the places in the file. The source
/// must outlive the parts.
[[nodiscard]] Configured<void> add_twincat(const SourceText& source,
                                           const DeclarationLimits& limits, ProgramParts& to);

} // namespace busbar::controller::detail
