#pragma once

#include <string_view>

#include <busbar/controller/plcopen_xml.hpp>

namespace busbar::controller {

/// Reads types and global variables from a file of any known format, which is recognized by its
/// content: PLCopen XML and IEC 61131-10 (read_plcopen_xml), an object of TwinCAT (.TcGVL, .TcDUT,
/// .TcPOU), the table of global variables that Sysmac Studio copies (lines of name, type, initial
/// value, AT, Retain, Constant, Network Publish and comment between tabs), the list of global
/// labels that GX Works exports (with a line of titles, between tabs or commas), or declarations
/// (read_declarations), with the places and the limits of these. A file that is none of them is
/// read as XML if its name ends with .xml, otherwise as declarations.
///
/// In the target busbar::plcopen_xml, which needs pugixml.
[[nodiscard]] BUSBAR_API Configured<Program>
read_program_text(std::string_view text, std::string_view file_name,
                  const DeclarationLimits& limits = {}, Unserved unserved = Unserved::Refuse,
                  TextEncoding encoding = TextEncoding::Recognized);

} // namespace busbar::controller
