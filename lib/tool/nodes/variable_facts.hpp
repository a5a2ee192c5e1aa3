#pragma once

#include <string>
#include <vector>

#include <busbar/types/enumerations.hpp>

#include "nodes.hpp"

namespace busbar::tool {

/// The attributes and properties of a Variable that help to tell its value.
struct ValueFacts {
    /// Null if it is not known.
    NodeId data_type{};
    /// The DataType's BrowseName and the EngineeringUnits (Part 8, 5.6.3), both `safe`; may be
    /// empty.
    std::string type_name{};
    std::string unit{};
    /// Unspecified for a Variable, and for a node that could not be asked.
    NodeClass node_class{NodeClass::Unspecified};
};

/// Selects what the server is asked for; each step costs a request or two more.
enum class FactsWanted : std::uint8_t { DataType, TypeName, All };
/// Requests the wanted facts about the nodes, and reads the DataTypes that name values. A node that
/// was not found has no facts.
[[nodiscard]] std::vector<ValueFacts>
facts_of(Connection& connection, const std::vector<NamedNode>& nodes, FactsWanted wanted);
/// Says that a node is, for example, an Object, which has no value; empty for a Variable, and for a
/// node whose NodeClass is not known.
[[nodiscard]] std::string reason_of_no_value(const ValueFacts& facts);
/// Makes a Failure from the status of the node's Value, with that reason if there is one.
[[nodiscard]] Failure value_failure(const NamedNode& node, StatusCode status,
                                    const ValueFacts& facts);
/// The name of each DataType, or the NodeId of one that has none; `safe`.
[[nodiscard]] std::vector<std::string> type_names(Connection& connection,
                                                  const std::vector<NodeId>& types);

} // namespace busbar::tool
