#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/client/methods.hpp>
#include <busbar/client/node_address.hpp>

#include "tool/connection/connection.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool {

/// A node that the user named, and what became of the name.
struct NamedNode {
    std::string text;
    Result<NodeId> id;
    /// If the name fits several nodes, texts that each name one of them. See Failure.
    std::vector<std::string> candidates{};
};

/// Their NodeIds; null where there is none.
[[nodiscard]] std::vector<NodeId> ids_of(const std::vector<NamedNode>& nodes);

/// Parses an address; throws Failure if it is neither a node id nor a path.
[[nodiscard]] client::NodeAddress parse_address(const std::string& text);
/// Throws Failure for the first text that is neither, before a server is asked for anything.
void check_addresses(const std::vector<std::string>& texts);
/// Resolves paths at the server; throws Failure for a text that is not an address.
[[nodiscard]] std::vector<NamedNode> find_nodes(Connection& connection,
                                                const std::vector<std::string>& texts);
/// The same for one; throws Failure if it is not there.
[[nodiscard]] NodeId find_node(Connection& connection, const std::string& text);
/// Its NodeId; throws Failure if it was not found.
[[nodiscard]] NodeId id_of(const Connection& connection, const NamedNode& node);
/// Throws Failure for the first text that fits several nodes; what else may be wrong with it is
/// seen later.
void refuse_ambiguous(Connection& connection, const std::vector<std::string>& texts);

/// Calls one Method and waits that long for the answer, or as long as --timeout says; throws
/// Failure without an answer.
[[nodiscard]] client::ExplainedCall
call_explained(Connection& connection, CallMethodRequest request, Duration timeout = {});
/// The server's name for the node in its additionalInfo, see refused_by_server.
[[nodiscard]] std::string operand_of(const NodeId& object, const NodeId& method);

/// Makes a Failure from the status of an operation on the node.
[[nodiscard]] Failure failure_of(const NamedNode& node, StatusCode status);
/// Lists the candidates of those that have any, below the results of the others.
void print_candidates(Output& err, const std::vector<NamedNode>& nodes);
/// The member "candidates" of an object, if there are any.
void append_candidates(JsonLine& json, const NamedNode& node);

/// Reads attributes of one node, the results in their order.
[[nodiscard]] std::vector<DataValue> read_attributes(Connection& connection, const NodeId& node,
                                                     const std::vector<AttributeId>& attributes);
/// Reads one attribute of many nodes. A node that was not found has that status.
[[nodiscard]] std::vector<DataValue> read_nodes(Connection& connection,
                                                const std::vector<NamedNode>& nodes,
                                                AttributeId attribute = AttributeId::Value,
                                                std::string_view index_range = {});

} // namespace busbar::tool
