#pragma once

#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// The name of the `<data>` that says how a variable is published (W588, 3-3-1),
/// in the `<addData>` of a `<variable>` or, for variables without one, of their `<globalVars>`:
///
///     <addData><data name="urn:busbar:network-publish" handleUnknown="preserve">
///       <publish>output</publish></data></addData>
///
/// Its content is as in a pragma of declarations: none, publish only, input or output.
inline constexpr std::string_view plcopen_publish_data = "urn:busbar:network-publish";

/// Reads types and global variables from PLCopen XML (TC6, versions 1.0 to 2.01): a `<project>`
/// in http://www.plcopen.org/xml/tc6_0200, tc6_0201 or tc6.xsd; or from IEC 61131-10: a `<Project>`
/// in www.iec.ch/public/TC65SC65BWG7TF10, whose elements have the same names with a capital.
///
/// Reads `<dataTypes>`, and from configurations and resources `<globalVars>`, tasks and
/// pouInstances, also if vendors have these in the project's `<addData>`, and `<union>` besides
/// `<struct>`. The value of a `<simpleValue>` is written as in declarations; `<documentation>`
/// becomes the comment. The bodies of programs and everything else are ignored. Of IEC 61131-10 it
/// reads `<DataTypeDecl>`, `<NamespaceDecl>` and the attribute networkPublish of Sysmac Studio.
///
/// Bounds, lengths, values of enumerations and of variables are expressions as in declarations.
///
/// `text` is in this encoding, see decode_text, and has no DOCTYPE. The limits are those of
/// declarations, where the elements of the XML count as memory too, and are nested as deep as
/// aggregates may be. Problems are like those of read_declarations, with the place of their
/// element: "machine.xml:12:5".
///
/// With Unserved::LeaveOut a `<dataType>` or a `<variable>` that is not understood goes to
/// Program::left_out.
///
/// In the target busbar::plcopen_xml, which needs pugixml.
[[nodiscard]] BUSBAR_API Configured<Program>
read_plcopen_xml(std::string_view text, std::string_view file_name,
                 const DeclarationLimits& limits = {}, Unserved unserved = Unserved::Refuse,
                 TextEncoding encoding = TextEncoding::Recognized);

} // namespace busbar::controller
