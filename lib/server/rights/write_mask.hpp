#pragma once

#include <cstdint>

#include <busbar/core/attribute_id.hpp>
#include <busbar/model/address_space.hpp>

#include "node_rights.hpp"

/// AttributeWriteMask (Part 3, 8.60): which attributes of a node, its Value aside, Write replaces.
/// NodeAccess::write_mask may name more than this server can write: no client sees those bits.
namespace busbar::server::detail {

/// The attribute's bit; 0 for one that has none.
[[nodiscard]] std::uint32_t write_mask_bit(AttributeId attribute);
/// The WriteMask of the node; 0 for a constant node.
[[nodiscard]] std::uint32_t write_mask(const model::AddressSpace& space, model::NodeIndex node);
/// What of it the user may: for RolePermissions with the permission WriteRolePermissions, for
/// AccessRestrictions with that and WriteAttribute, for all others with WriteAttribute (Part 3,
/// 8.55). Without CurrentWrite in his mask a user may nothing, and where no RolePermissions count
/// rights are changed by administrators alone. The channel is not looked at.
[[nodiscard]] std::uint32_t user_write_mask(const NodeRights& rights, model::NodeIndex node);

} // namespace busbar::server::detail
