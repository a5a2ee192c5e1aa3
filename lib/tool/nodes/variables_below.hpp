#pragma once

#include <string>
#include <vector>

#include <busbar/client/view.hpp>

#include "node_feed.hpp"

namespace busbar::tool {

struct VariableBelow {
    /// The address is its NodeId, the text a path.
    FeedNode node;
    /// The path from the node that it was looked for below of.
    std::string name;
};

struct VariablesBelow {
    std::vector<VariableBelow> variables;
    /// Number of Variables beyond the wanted ones.
    std::size_t left_out{0};
    /// False if a failure, or a limit, kept something out.
    bool is_complete{true};
};

/// The Variables below the nodes that the user names, in the order of the levels, without
/// Properties; if none is named, those below Objects that are not in namespace 0. At most `limit`.
/// Throws Failure.
[[nodiscard]] VariablesBelow
variables_below(Connection& connection, const std::vector<std::string>& nodes, std::size_t limit);

/// "/Objects/2:Machine/2:Speed": the address of a node of a tree that was browsed from one node,
/// `root`, which the user calls `name`.
[[nodiscard]] std::string path_below(const NodeId& root, const std::string& name,
                                     const client::BrowsedTree& tree, std::size_t index);

} // namespace busbar::tool
