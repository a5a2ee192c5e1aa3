#include "part_rights.hpp"

namespace busbar::product {

std::vector<NodeId> nodes_of(administration::detail::Roles roles)
{
    namespace who = administration::detail::who;
    struct KnownRole {
        administration::detail::Roles bit;
        std::uint32_t id;
    };
    static constexpr std::array known{
        KnownRole{who::everybody, id::WellKnownRole_Anonymous},
        KnownRole{who::operator_, id::WellKnownRole_Operator},
        KnownRole{who::supervisor, id::WellKnownRole_Supervisor},
        KnownRole{who::engineer, id::WellKnownRole_Engineer},
        KnownRole{who::configure_admin, id::WellKnownRole_ConfigureAdmin},
        KnownRole{who::security_admin, id::WellKnownRole_SecurityAdmin},
    };
    std::vector<NodeId> nodes;
    for (const KnownRole& role : known) {
        if ((roles & role.bit) != 0) {
            nodes.emplace_back(std::uint16_t{0}, role.id);
        }
    }
    return nodes;
}

} // namespace busbar::product
