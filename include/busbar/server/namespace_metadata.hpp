#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/array.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/types/data_types.hpp>

namespace busbar::model {
struct NodeSetModel;
}

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
    /// Set: AddressSpace::set_namespace_permissions and set_namespace_restrictions with them; else
    /// those stay as they are.
    std::optional<Array<RolePermissionType>> default_role_permissions{};
    std::optional<std::uint16_t> default_access_restrictions{};
};

class Server;

/// Has Server.Namespaces say the version and publication date of models from NodeSet2 files, as
/// model::load_nodesets returns them in NodeSetExtras::models. A model whose URI is no namespace of
/// the server, or a small namespace 0 without NamespaceMetadataType: nothing is said.
BUSBAR_API void describe_models(Server& server, std::span<const model::NodeSetModel> models);

} // namespace busbar::server
