#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/attribute_id.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/types/enumerations.hpp>

namespace busbar::tool {

/// Returns a name such as "Variable"; "?" if it is not a NodeClass.
[[nodiscard]] std::string_view name(NodeClass node_class);
/// Returns a name such as "DisplayName"; "?" if it is not an AttributeId.
[[nodiscard]] std::string_view name(AttributeId attribute);
[[nodiscard]] std::vector<std::string> attribute_names();
[[nodiscard]] std::optional<AttributeId> find_attribute(std::string_view name);
/// The DataType of an attribute's values (Part 3, 5), which names its numbers; null for others and
/// for the Value, whose DataType is the Variable's.
[[nodiscard]] NodeId type_of(AttributeId attribute);

} // namespace busbar::tool
