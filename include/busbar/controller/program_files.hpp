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
/// - a .plcproj of TwinCAT, under any name: the files that it compiles, which must be in its
/// folder.
///
/// Files have the names that they have from the folder or from the list on, so that the same folder
/// elsewhere has the same text; a second file of a name has its path as given. Symbolic links are
/// followed to files in the same folder or below it, and not to folders. Files that cannot be read
/// are noted in the text, with the reason.
///
/// Fails with Bad_NotFound if a path cannot be read; with Bad_EncodingLimitsExceeded if the text
/// has more than `max_size` bytes, or a .plcproj more than 4 MiB; with Bad_ConfigurationError for a
/// folder without a file of a program or with more than 200,000 entries or two lists, for a list
/// that is not well-formed or compiles no file with declarations, and for more than 10,000 files.
///
/// In the target busbar::plcopen_xml, which needs pugixml.
[[nodiscard]] BUSBAR_API Configured<std::string> read_program_files(const std::string& paths,
                                                                    std::size_t max_size);

/// Tells whether the path is that of a list of files, a .plcproj of TwinCAT under any name, so that
/// the program is all of its folder. Reads the file.
[[nodiscard]] BUSBAR_API bool is_program_list(const std::string& path);

} // namespace busbar::controller
