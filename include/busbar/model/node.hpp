#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <busbar/core/types.hpp>
#include <busbar/types/enumerations.hpp>
#include <busbar/types/node_attributes.hpp>

namespace busbar::model {

/// Identifies a node of an AddressSpace while that node exists; afterwards another node may get the
/// index. Use a NodeHandle for anything that is kept longer than a call.
enum class NodeIndex : std::uint32_t {};
/// Stands for a node that does not exist.
inline constexpr NodeIndex no_node{UINT32_MAX};

/// Identifies a node for ever: after its removal no node has the handle.
struct NodeHandle {
    NodeIndex index{no_node};
    std::uint32_t generation{0};

    friend bool operator==(const NodeHandle&, const NodeHandle&) = default;
};

/// One reference as seen from the node it belongs to.
struct Reference {
    NodeIndex type{no_node};
    NodeIndex target{no_node};
    bool is_forward{true};
};

/// The source of a Variable whose value is in the AddressSpace itself.
inline constexpr std::uint32_t no_source = UINT32_MAX;

/// The attributes of a Variable or VariableType that services need; the span is valid until the
/// node changes.
struct VariableAttributes {
    NodeIndex data_type{no_node};
    std::int32_t value_rank{-1};
    std::span<const std::uint32_t> array_dimensions;
    double minimum_sampling_interval{0};
    /// Bits of AccessLevelType; 0 for a VariableType.
    std::uint8_t access_level{0};
    std::uint8_t user_access_level{0};
    bool historizing{false};
    /// The data source's index in the server, and the source's handle of the value.
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
};

/// The attributes of a Method that services need.
struct MethodAttributes {
    /// The Executable attribute.
    bool executable{false};
    /// The source that carries it out, as VariableAttributes::source.
    std::uint32_t source{no_source};
    std::uint64_t handle{0};
};

/// Attributes that few nodes have (Part 3, 5.2.7 to 5.2.11 and 8.58). NodeSet2 files have them.
struct NodeAccess {
    /// WriteMask: the attributes that clients may write, of those that a server can write. A server
    /// writes DisplayName, Description, InverseName, MinimumSamplingInterval, RolePermissions and
    /// AccessRestrictions, of dynamic nodes, and shows only their bits.
    std::uint32_t write_mask{0};
    /// The bits of AccessLevelEx above those of AccessLevel.
    std::uint32_t more_access_levels{0};
    /// Bits of AccessRestrictionType. If nothing, those of the node's namespace apply.
    std::optional<std::uint16_t> restrictions{};
    /// Null if the node has none of its own, and those of its namespace apply; empty if all access
    /// is denied.
    Array<RolePermissionType> role_permissions{};

    friend bool operator==(const NodeAccess&, const NodeAccess&) = default;
};

} // namespace busbar::model
