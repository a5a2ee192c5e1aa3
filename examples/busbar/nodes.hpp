#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/client/node_address.hpp>

#include "connection.hpp"

namespace busbar::cli {

/// A node that the user named, and what became of the name.
struct NamedNode {
    std::string text;
    Result<NodeId> id;
};

/// What the text says; throws Failure if it is no node id and no path.
[[nodiscard]] client::NodeAddress parse_address(const std::string& text);
/// Throws Failure for the first text that is neither, before a server is asked for anything.
void check_addresses(const std::vector<std::string>& texts);
/// Asks the server for what are paths; throws Failure for a text that is no address.
[[nodiscard]] std::vector<NamedNode> find_nodes(Connection& connection,
                                                const std::vector<std::string>& texts);
/// The same for one; throws Failure if it is not there.
[[nodiscard]] NodeId find_node(Connection& connection, const std::string& text);

/// Reads attributes of one node, the results in their order.
[[nodiscard]] std::vector<DataValue> read_attributes(Connection& connection, const NodeId& node,
                                                     const std::vector<AttributeId>& attributes);
/// Reads one attribute of many nodes. A node that was not found has that status.
[[nodiscard]] std::vector<DataValue> read_nodes(Connection& connection,
                                                const std::vector<NamedNode>& nodes,
                                                AttributeId attribute = AttributeId::Value,
                                                std::string_view index_range = {});

} // namespace busbar::cli
