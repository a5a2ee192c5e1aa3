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
#include <busbar/types/node_attributes.hpp>

namespace busbar::model {
struct NodeSetModel;
}

namespace busbar::server {

/// The properties of a namespace in Server.Namespaces beyond its URI (Part 5, 6.3.13,
/// NamespaceMetadataType). The default is empty.
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
    /// If set, AddressSpace::set_namespace_permissions and set_namespace_restrictions are called
    /// with them; else those stay as they are.
    std::optional<Array<RolePermissionType>> default_role_permissions{};
    std::optional<std::uint16_t> default_access_restrictions{};
};

class Server;

/// Sets the version and publication date in Server.Namespaces for models from NodeSet2 files, as
/// model::load_nodesets returns them in NodeSetExtras::models. Ignores a model whose URI is not a
/// namespace of the server, and does nothing in a small namespace 0 without NamespaceMetadataType.
BUSBAR_API void describe_models(Server& server, std::span<const model::NodeSetModel> models);

} // namespace busbar::server
