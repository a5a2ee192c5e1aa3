#pragma once

#include <string>
#include <vector>

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
};

/// Selects what the server is asked for; each step costs a request or two more.
enum class FactsWanted : std::uint8_t { DataType, TypeName, All };
/// Requests the wanted facts about the nodes, and reads the DataTypes that name values. A node that
/// was not found has no facts.
[[nodiscard]] std::vector<ValueFacts>
facts_of(Connection& connection, const std::vector<NamedNode>& nodes, FactsWanted wanted);
/// The name of each DataType, or the NodeId of one that has none; `safe`.
[[nodiscard]] std::vector<std::string> type_names(Connection& connection,
                                                  const std::vector<NodeId>& types);

} // namespace busbar::tool
