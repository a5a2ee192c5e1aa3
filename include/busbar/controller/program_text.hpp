#pragma once

#include <string_view>

#include <busbar/controller/plcopen_xml.hpp>

namespace busbar::controller {

/// Reads types and global variables from a file of any known format, which is recognized by its
/// content: PLCopen XML and IEC 61131-10 (read_plcopen_xml), an object of TwinCAT (.TcGVL, .TcDUT,
/// .TcPOU), the table of global variables that Sysmac Studio copies (lines of name, type, initial
/// value, AT, Retain, Constant, Network Publish and comment between tabs), the list of global
/// labels or of a structure's members that GX Works exports (with a line of titles, between tabs or
/// commas), or declarations (read_declarations), with the places and the limits of these. A file
/// that is none of them is read as XML if its name ends with .xml, otherwise as declarations; one
/// of a format that is known and not read is refused with its name.
///
/// The text may also be that of several files which read_program_files() joined: they are read as
/// one program, in which all see each other's names. Problems have the name of the file. With
/// Unserved::LeaveOut a file that cannot be read at all goes to Program::left_out.
///
/// In the target busbar::plcopen_xml, which needs pugixml.
[[nodiscard]] BUSBAR_API Configured<Program>
read_program_text(std::string_view text, std::string_view file_name,
                  const DeclarationLimits& limits = {}, Unserved unserved = Unserved::Refuse,
                  TextEncoding encoding = TextEncoding::Recognized);

/// Returns the Program::encoding of a text that was asked to be read in `encoding`; Recognized if
/// it cannot be read.
[[nodiscard]] BUSBAR_API TextEncoding program_encoding(std::string_view text,
                                                       TextEncoding encoding);

} // namespace busbar::controller
