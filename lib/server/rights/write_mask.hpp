#pragma once

#include <cstdint>

#include <busbar/core/attribute_id.hpp>
#include <busbar/model/address_space.hpp>

#include "node_rights.hpp"

/// AttributeWriteMask (Part 3, 8.60): the attributes of a node, other than its Value, that Write
/// can replace. NodeAccess::write_mask may name more than this server can write: clients do not see
/// those bits.
namespace busbar::server::detail {

/// Returns the attribute's bit; 0 for one that has none.
[[nodiscard]] std::uint32_t write_mask_bit(AttributeId attribute);
/// Returns the WriteMask of the node; 0 for a constant node.
[[nodiscard]] std::uint32_t write_mask(const model::AddressSpace& space, model::NodeIndex node);
/// Returns the part of it that the user may write: RolePermissions with the permission
/// WriteRolePermissions, AccessRestrictions with that and WriteAttribute, all others with
/// WriteAttribute (Part 3, 8.55). Without CurrentWrite in his mask a user may write nothing, and if
/// no RolePermissions apply only administrators change rights. The channel is not checked.
[[nodiscard]] std::uint32_t user_write_mask(const NodeRights& rights, model::NodeIndex node);

} // namespace busbar::server::detail
