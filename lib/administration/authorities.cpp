#include <busbar/administration/authorities.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "permissions.hpp"

namespace busbar::administration {

namespace {

struct RoleOfAuthority {
    Authority authority;
    std::uint32_t role;
};
constexpr std::array roles_of_authorities{
    RoleOfAuthority{Authority::Observer, id::WellKnownRole_Observer},
    RoleOfAuthority{Authority::Operator, id::WellKnownRole_Operator},
    RoleOfAuthority{Authority::Maintainer, id::WellKnownRole_Supervisor},
    RoleOfAuthority{Authority::Designer, id::WellKnownRole_Engineer},
    RoleOfAuthority{Authority::Administrator, id::WellKnownRole_ConfigureAdmin},
    RoleOfAuthority{Authority::Administrator, id::WellKnownRole_SecurityAdmin},
};

/// Adds permissions to those that the role has.
void permit(model::NodeAccess& access, std::uint32_t role, PermissionType permissions)
{
    const auto found =
        std::find_if(access.role_permissions.begin(), access.role_permissions.end(),
                     [&](const RolePermissionType& each) { return each.role_id.is(role); });
    if (found == access.role_permissions.end()) {
        access.role_permissions.push_back({NodeId{0, role}, permissions});
    } else {
        found->permissions = detail::together(found->permissions, permissions);
    }
}

} // namespace

std::optional<Authorities> find_authorities(std::string_view name)
{
    return name == "standard"      ? std::optional{Authorities::Standard}
           : name == "five levels" ? std::optional{Authorities::FiveLevels}
                                   : std::nullopt;
}

model::NodeAccess access_from(Authority reads, Authority acts)
{
    model::NodeAccess access;
    access.restrictions = static_cast<std::uint16_t>(AccessRestrictionType::EncryptionRequired);
    for (const auto& [authority, role] : roles_of_authorities) {
        if (authority >= reads) {
            permit(access, role, detail::may_see);
        }
        if (authority >= acts) {
            permit(access, role, detail::may_act);
        }
    }
    return access;
}

} // namespace busbar::administration
