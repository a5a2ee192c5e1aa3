#include "node_rights.hpp"

#include <array>

#include <busbar/types/enumerations.hpp>

namespace busbar::server::detail {

namespace {

struct MaskRow {
    AttributeId attribute;
    AttributeWriteMask bit;
    bool is_written{false};
};

/// Attributes that cannot be written describe the node's nature, which its creator decides: its
/// type and class, its names for programs, and whether it has a source or a history.
constexpr std::array mask_rows{
    MaskRow{AttributeId::AccessLevel, AttributeWriteMask::AccessLevel},
    MaskRow{AttributeId::ArrayDimensions, AttributeWriteMask::ArrayDimensions},
    MaskRow{AttributeId::BrowseName, AttributeWriteMask::BrowseName},
    MaskRow{AttributeId::ContainsNoLoops, AttributeWriteMask::ContainsNoLoops},
    MaskRow{AttributeId::DataType, AttributeWriteMask::DataType},
    MaskRow{AttributeId::Description, AttributeWriteMask::Description, true},
    MaskRow{AttributeId::DisplayName, AttributeWriteMask::DisplayName, true},
    MaskRow{AttributeId::EventNotifier, AttributeWriteMask::EventNotifier},
    MaskRow{AttributeId::Executable, AttributeWriteMask::Executable},
    MaskRow{AttributeId::Historizing, AttributeWriteMask::Historizing},
    MaskRow{AttributeId::InverseName, AttributeWriteMask::InverseName, true},
    MaskRow{AttributeId::IsAbstract, AttributeWriteMask::IsAbstract},
    MaskRow{AttributeId::MinimumSamplingInterval, AttributeWriteMask::MinimumSamplingInterval,
            true},
    MaskRow{AttributeId::NodeClass, AttributeWriteMask::NodeClass},
    MaskRow{AttributeId::NodeId, AttributeWriteMask::NodeId},
    MaskRow{AttributeId::Symmetric, AttributeWriteMask::Symmetric},
    MaskRow{AttributeId::UserAccessLevel, AttributeWriteMask::UserAccessLevel},
    MaskRow{AttributeId::UserExecutable, AttributeWriteMask::UserExecutable},
    MaskRow{AttributeId::UserWriteMask, AttributeWriteMask::UserWriteMask},
    MaskRow{AttributeId::ValueRank, AttributeWriteMask::ValueRank},
    MaskRow{AttributeId::WriteMask, AttributeWriteMask::WriteMask},
    MaskRow{AttributeId::Value, AttributeWriteMask::ValueForVariableType},
    MaskRow{AttributeId::DataTypeDefinition, AttributeWriteMask::DataTypeDefinition},
    MaskRow{AttributeId::RolePermissions, AttributeWriteMask::RolePermissions, true},
    MaskRow{AttributeId::AccessRestrictions, AttributeWriteMask::AccessRestrictions, true},
    MaskRow{AttributeId::AccessLevelEx, AttributeWriteMask::AccessLevelEx},
};

constexpr auto bit_of_roles = static_cast<std::uint32_t>(AttributeWriteMask::RolePermissions);
constexpr auto bit_of_restrictions =
    static_cast<std::uint32_t>(AttributeWriteMask::AccessRestrictions);
constexpr std::uint32_t bits_of_rights = bit_of_roles | bit_of_restrictions;

/// Returns the bits that a user's permissions deny.
std::uint32_t forbidden_bits(const NodeRights& rights, model::NodeIndex node)
{
    if (rights.space.role_permissions(node) == nullptr) {
        return is_administrator(rights.space, rights.user) ? 0 : bits_of_rights;
    }
    const std::uint32_t without_attributes =
        rights.is_permitted(PermissionType::WriteAttribute, node) ? 0 : ~bit_of_roles;
    const std::uint32_t without_roles =
        rights.is_permitted(PermissionType::WriteRolePermissions, node) ? 0 : bits_of_rights;
    return without_attributes | without_roles;
}

} // namespace

std::uint32_t write_mask_bit(AttributeId attribute)
{
    for (const MaskRow& row : mask_rows) {
        if (row.attribute == attribute) {
            return static_cast<std::uint32_t>(row.bit);
        }
    }
    return 0;
}

std::uint32_t write_mask(const model::AddressSpace& space, model::NodeIndex node)
{
    const model::NodeAccess* const access = space.node_access(node);
    if (access == nullptr || access->write_mask == 0 || space.is_constant(node)) {
        return 0;
    }
    std::uint32_t mask = 0;
    for (const MaskRow& row : mask_rows) {
        if (row.is_written &&
            model::AddressSpace::has_attribute(space.node_class(node), row.attribute)) {
            mask |= static_cast<std::uint32_t>(row.bit);
        }
    }
    return access->write_mask & mask;
}

std::uint32_t user_write_mask(const NodeRights& rights, model::NodeIndex node)
{
    constexpr auto current_write = static_cast<std::uint8_t>(AccessLevelType::CurrentWrite);
    std::uint32_t mask = write_mask(rights.space, node);
    if (mask == 0 || (rights.user.access_level_mask & current_write) == 0) {
        return 0;
    }
    mask &= ~forbidden_bits(rights, node);
    if (mask != 0 && rights.control != nullptr) {
        mask &= rights.control->user_write_mask(rights.user, rights.space.node_id(node), mask);
    }
    return mask;
}

} // namespace busbar::server::detail
