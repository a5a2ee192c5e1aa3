#pragma once

#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/result.hpp>
#include <busbar/types/view.hpp>

namespace busbar::binary {

/// Reads a RelativePath as text (Part 4, A.2): "/2:Block&.Output", "/3:Truck.0:NodeVersion",
/// "<1:ConnectedTo>1:Boiler/1:HeatSensor", "<#!HasChild>Truck".
///
/// `find_type` returns the NodeId of the ReferenceType of that BrowseName, null for an unknown one.
/// Bad_SyntaxError for a text of another form, Bad_ReferenceTypeIdInvalid for an unknown
/// ReferenceType. The result owns its strings. Takes linear time and memory; the caller limits the
/// length of the text.
[[nodiscard]] BUSBAR_API Result<RelativePath>
parse_relative_path(std::string_view text, FunctionRef<NodeId(const QualifiedName&)> find_type);

/// Returns the text that parse_relative_path reads as `path`. `name_of` returns the BrowseName of a
/// ReferenceType, an empty one for an unknown one. Bad_ReferenceTypeIdInvalid for an unknown or
/// null ReferenceType; Bad_BrowseNameInvalid if an element other than the last one has no
/// targetName or a null name has a namespace, since there is no text for these.
[[nodiscard]] BUSBAR_API Result<std::string>
to_text(const RelativePath& path, FunctionRef<QualifiedName(const NodeId&)> name_of);

} // namespace busbar::binary
