#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <busbar/core/node_id.hpp>
#include <busbar/types/ids.hpp>

#include "administration/rights.hpp"

/// The rows that a controller adds to the table of rights (administration/rights.hpp): the roles
/// that see each of its parts, and those that change it. Its folders and transfers get their
/// readers and writers from it, and its Methods their RolePermissions.
namespace busbar::product {

/// The Objects of a controller that administrators use, besides those of `[[files]]`, whose readers
/// and writers the configuration names.
enum class AdministeredPart : std::uint8_t {
    ExecutionLog,
    EventLog,
    Program,
    Backup,
    Project,
    Hardware,
    Count
};

/// `see` is for Browse, for reading Variables, and for Methods that read files; `change` is for all
/// other Methods.
struct PartRight {
    AdministeredPart part;
    /// BrowseName of the Object.
    std::string_view name;
    std::uint16_t channel; // AccessRestrictions of its nodes
    administration::detail::Roles see;
    administration::detail::Roles change;
};

inline constexpr std::array part_rights = [] {
    namespace who = administration::detail::who;
    namespace over = administration::detail::over;
    using Part = AdministeredPart;
    constexpr auto security = who::security_admin;
    constexpr auto log_clearer = who::supervisor | who::engineer | who::security_admin;
    // clang-format off
    return std::array{
        // W588, 7-3: change stands for deleting complete files, and for beginning a new one
        PartRight{Part::ExecutionLog, "ExecutionLog", over::encrypted, who::operators, log_clearer},
        PartRight{Part::EventLog,     "EventLog",     over::encrypted, who::operators, who::nobody},
        // W588, 8-1
        PartRight{Part::Program,      "Program",      over::encrypted, who::engineers,
                                                                       who::engineers},
        PartRight{Part::Backup,       "Backup",       over::encrypted, security,       security},
        // A project contains users, their hashes and rules for access without security.
        PartRight{Part::Project,      "Project",      over::encrypted, security,       security},
        // Simulated, and for those who may stop a server (W588, 8-1)
        PartRight{Part::Hardware,     "Hardware",     over::any,       who::engineers,
                                                                       who::engineers},
    };
    // clang-format on
}();

static_assert(part_rights.size() == static_cast<std::size_t>(AdministeredPart::Count));
static_assert([] {
    for (std::size_t i = 0; i < part_rights.size(); ++i) {
        if (part_rights[i].part != static_cast<AdministeredPart>(i)) {
            return false;
        }
    }
    return true;
}());

[[nodiscard]] constexpr const PartRight& right_of(AdministeredPart part)
{
    return part_rights[static_cast<std::size_t>(part)];
}

/// Returns the NodeIds of the well-known roles that the bits stand for.
[[nodiscard]] inline std::vector<NodeId> nodes_of(administration::detail::Roles roles)
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
