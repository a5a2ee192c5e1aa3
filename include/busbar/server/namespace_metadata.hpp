#pragma once

#include <string>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/node_id.hpp>

namespace busbar::server {

/// What Server.Namespaces says of a namespace beyond its URI (Part 5, 6.3.13,
/// NamespaceMetadataType). The default says nothing.
struct NamespaceMetadata {
    std::string version;
    DateTime publication_date;
    /// The server has only a part of the namespace's nodes.
    bool is_subset{false};
    /// Static nodes are the same in every server, values included: all nodes whose NodeIds have one
    /// of these types,
    std::vector<IdType> static_node_id_types;
    /// those with numeric identifiers within one of these ranges, such as "1000:2000",
    std::vector<std::string> static_numeric_ranges;
    /// and those with identifiers that match this pattern of the operator Like (Part 4, 7.7.3).
    std::string static_string_pattern;
};

} // namespace busbar::server
