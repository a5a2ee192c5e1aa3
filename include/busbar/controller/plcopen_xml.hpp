#pragma once

#include <string_view>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// The name of the <data> that says how a variable is published (seed 000, 3-3-1), in the <addData>
/// of a <variable> or, for those that have none, of its <globalVars>:
///
///     <addData><data name="urn:busbar:network-publish" handleUnknown="preserve">
///       <publish>output</publish></data></addData>
///
/// What stands in it is what a pragma of declarations says: none, publish only, input or output.
inline constexpr std::string_view plcopen_publish_data = "urn:busbar:network-publish";

/// Types and global variables from PLCopen XML (TC6, versions 2.00 and 2.01): a <project> in
/// http://www.plcopen.org/xml/tc6_0200 or tc6_0201.
///
/// Read are <dataTypes>, and of configurations and resources <globalVars>, tasks and pouInstances,
/// also where vendors have these in the project's <addData>, as well as <union> beside <struct>. A
/// value of a <simpleValue> is written as in declarations; <documentation> becomes the comment. The
/// bodies of programs and what is not named here mean nothing.
///
/// `text` is UTF-8 and has no DOCTYPE. The limits are those of declarations, where the elements of
/// the XML count as memory, too, and nest as deep as aggregates may. Problems are as those of
/// read_declarations, at the element they are in: "machine.xml:12:5".
///
/// Of the target busbar::plcopen_xml, which needs pugixml.
[[nodiscard]] BUSBAR_API Configured<Program> read_plcopen_xml(std::string_view text,
                                                              std::string_view file_name,
                                                              const DeclarationLimits& limits = {});

} // namespace busbar::controller
