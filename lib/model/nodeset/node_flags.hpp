#pragma once

#include <cstdint>

#include <busbar/model/static_nodes.hpp>

#include "document.hpp"
#include "model/type_class.hpp"

namespace busbar::nodeset {

[[nodiscard]] inline bool is_type(const Node& node)
{
    return model::detail::is_type(node.node_class);
}

/// True for nodes that have a type definition.
[[nodiscard]] inline bool is_instance(NodeClass node_class)
{
    return node_class == NodeClass::Object || node_class == NodeClass::Variable;
}

/// The bits of model::static_flag.
[[nodiscard]] inline std::uint8_t flags(const Node& node)
{
    using namespace model::static_flag;
    const auto flag = [](bool is_set, std::uint8_t bit) { return is_set ? bit : 0; };
    const bool is_method = node.node_class == NodeClass::Method;
    return static_cast<std::uint8_t>(
        flag(is_type(node) && node.is_abstract, is_abstract) | flag(node.symmetric, symmetric) |
        flag(node.contains_no_loops, contains_no_loops) |
        flag(is_method && node.executable, executable) | flag(node.historizing, historizing));
}

} // namespace busbar::nodeset
