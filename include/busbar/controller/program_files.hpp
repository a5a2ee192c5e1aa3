#pragma once

#include <cstddef>
#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// Returns the text of a program at a path, or at several paths with a line feed between them, for
/// read_program_text(). A path may be
///
/// - a file;
/// - a folder: all files in it and in the folders below it whose names end as those of programs do
///   (.st, .xml, .TcGVL, .csv and others), in the order of their names; or what its .plcproj says,
///   if it has one;
/// - a .plcproj of TwinCAT: the files that it compiles, which must be in its folder.
///
/// Symbolic links are followed to files in the same folder or below it, and not to folders. Files
/// that cannot be read are noted in the text, with the reason. Fails if a path cannot be read, with
/// Bad_NotFound, if there are more than 10,000 files, or if the text has more than `max_size`
/// bytes, with Bad_EncodingLimitsExceeded.
///
/// In the target busbar::plcopen_xml, which needs pugixml.
[[nodiscard]] BUSBAR_API Configured<std::string> read_program_files(const std::string& paths,
                                                                    std::size_t max_size);

} // namespace busbar::controller
