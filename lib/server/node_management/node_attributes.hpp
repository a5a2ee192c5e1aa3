#pragma once

#include <cstdint>
#include <optional>

#include <busbar/model/node.hpp>
#include <busbar/types/node_management.hpp>

namespace busbar::server::detail {

/// The attributes that an AddNodes item has for its node; empty ones are left to the server.
struct NodeAttributeValues {
    LocalizedText display_name;
    LocalizedText description;
    LocalizedText inverse_name;
    std::optional<bool> is_abstract;
    std::optional<bool> symmetric;
    std::optional<bool> contains_no_loops;
    std::optional<bool> executable;
    std::optional<std::uint8_t> event_notifier;
    std::optional<std::uint8_t> access_level;
    std::optional<std::uint8_t> user_access_level;
    std::optional<double> minimum_sampling_interval;
    std::optional<NodeId> data_type;
    std::optional<std::int32_t> value_rank;
    std::optional<Array<std::uint32_t>> array_dimensions;
    std::optional<Variant> value;
    ExtensionObject definition;
};

/// Reads the structure for the NodeClass or GenericAttributes (Part 4, 7.24); a null one has none.
///
/// Bad_NodeAttributesInvalid for another structure, for an attribute that the NodeClass does not
/// have, that appears twice or is of another type, and for attributes that clients may not set: a
/// WriteMask, roles, restrictions, history.
[[nodiscard]] Result<NodeAttributeValues> read_attributes(const ExtensionObject& attributes,
                                                          NodeClass node_class);

} // namespace busbar::server::detail
