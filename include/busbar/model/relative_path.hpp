#pragma once

#include <string>
#include <string_view>

#include <busbar/binary/relative_path.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/space_reader.hpp>
#include <busbar/types/common.hpp>
#include <busbar/types/view.hpp>

namespace busbar::model {

using binary::parse_relative_path;
using binary::to_text;

/// Calls binary::parse_relative_path with the ReferenceTypes of an address space. Those of
/// namespace 0 are always known.
[[nodiscard]] BUSBAR_API Result<RelativePath> parse_relative_path(std::string_view text,
                                                                  const SpaceReader& space);
/// Calls binary::to_text with the ReferenceTypes of an address space.
[[nodiscard]] BUSBAR_API Result<std::string> to_text(const RelativePath& path,
                                                     const SpaceReader& space);

/// Returns the ReferenceType of this BrowseName, no_node if there is none. BrowseNames of types are
/// unique in their namespace (Part 3, 5.3.1); walks the tree of ReferenceTypes.
[[nodiscard]] BUSBAR_API NodeIndex find_reference_type(const SpaceReader& space,
                                                       const QualifiedName& name);

} // namespace busbar::model
