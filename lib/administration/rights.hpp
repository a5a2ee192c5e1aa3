#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <busbar/administration/authorities.hpp>
#include <busbar/model/address_space.hpp>

/// Who may do what with which part of the administration, and over which channel: one table, from
/// which the nodes get their RolePermissions and AccessRestrictions. The server enforces those.
namespace busbar::administration::detail {

/// Roles as bits.
using Roles = std::uint16_t;
namespace who {
inline constexpr Roles nobody = 0;
/// The role Anonymous, which every session has.
inline constexpr Roles everybody = 1U << 0U;
inline constexpr Roles operator_ = 1U << 1U;
inline constexpr Roles supervisor = 1U << 2U;
inline constexpr Roles engineer = 1U << 3U;
inline constexpr Roles configure_admin = 1U << 4U;
inline constexpr Roles security_admin = 1U << 5U;
/// Roles that the program names, see NamedRoles.
inline constexpr Roles readers = 1U << 6U;
inline constexpr Roles writers = 1U << 7U;

inline constexpr Roles admins = configure_admin | security_admin;
inline constexpr Roles engineers = engineer | admins;
inline constexpr Roles operators = operator_ | supervisor | engineers;
} // namespace who

/// AccessRestrictions (Part 3, 8.56).
namespace over {
inline constexpr std::uint16_t any = 0;
inline constexpr std::uint16_t is_signed = 1;
inline constexpr std::uint16_t encrypted = 3;      // which is signed, too
inline constexpr std::uint16_t signed_session = 5; // not without a session
} // namespace over

/// What a right is about.
enum class Thing : std::uint8_t {
    StateChange,      // RequestServerStateChange
    ServerStatus,     // ServerDiagnosticsSummary
    ServiceStatus,    // the Object "Status", see StatusFact
    Roles,            // the RoleSet and its roles
    RoleRules,        // what a role consists of, AddRole and RemoveRole
    UserManagement,   // the Object, and the rules for passwords
    Users,            // the list, and what changes it
    OwnPassword,      // ChangePassword
    ServerFacts,      // ServerConfiguration and its Variables
    TrustLists,       // groups, trust lists, rejected certificates, and transactions as they are
    TrustListChanges, // what changes a trust list
    TransactionEnds,  // ApplyChanges and CancelChanges
    OwnCertificate,   // what changes or gives away the server's certificate
    Reset,            // ResetToServerDefaults
    Settings,         // the Object, its Method, and settings but those of security
    SecuritySettings, // Setting::is_security
    Files,            // files and folders, and what reads them
    FileChanges,      // what changes files
    Count
};

/// Browse and Read; Write of Variables; Call of Methods, and of an Object's Methods.
struct Rights {
    Roles see;
    Roles write;
    Roles call;
};

/// `five_levels` counts with Authorities::FiveLevels.
struct RightOfThing {
    constexpr RightOfThing(Thing t, std::uint16_t c, const Rights& all)
        : RightOfThing{t, c, all, all}
    {
    }
    constexpr RightOfThing(Thing t, std::uint16_t c, const Rights& as_standard, const Rights& five)
        : thing{t}, channel{c}, standard{as_standard}, five_levels{five}
    {
    }

    Thing thing;
    std::uint16_t channel;
    Rights standard;
    Rights five_levels;
};

inline constexpr std::array rights_of_things = [] {
    using namespace who;
    using Row = RightOfThing;
    constexpr Roles security = security_admin;
    constexpr Roles user = everybody | security_admin;
    constexpr Roles user_or_admin = everybody | admins;
    constexpr Roles list_reader = operator_ | supervisor | engineer | security_admin;
    // clang-format off
    return std::array{
        // Part 5, 9.4
        Row{Thing::StateChange,      over::is_signed,      {admins, nobody, admins},
                                                           {engineers, nobody, engineers}},
        Row{Thing::ServerStatus,     over::any,            {user_or_admin, nobody, nobody},
                                                           {operators, nobody, nobody}},
        Row{Thing::ServiceStatus,    over::encrypted,      {operators, nobody, nobody}},
        // Part 18, 4.2 and 4.4
        Row{Thing::Roles,            over::any,            {user, nobody, security}},
        Row{Thing::RoleRules,        over::encrypted,      {security, security, security}},
        // Part 18, 5.2
        Row{Thing::UserManagement,   over::any,            {user, nobody, user}},
        Row{Thing::Users,            over::encrypted,      {security, nobody, security},
                                                           {list_reader, nobody, security}},
        Row{Thing::OwnPassword,      over::encrypted,      {user, nobody, user}},
        // Part 12, 7.8.2 and 7.10
        Row{Thing::ServerFacts,      over::any,            {user_or_admin, nobody, admins},
                                                           {operators, nobody, operators}},
        Row{Thing::TrustLists,       over::is_signed,      {security, nobody, security},
                                                           {list_reader, nobody, list_reader}},
        Row{Thing::TrustListChanges, over::is_signed,      {security, nobody, security}},
        Row{Thing::TransactionEnds,  over::signed_session, {security, nobody, security}},
        Row{Thing::OwnCertificate,   over::encrypted,      {security, nobody, security}},
        Row{Thing::Reset,            over::is_signed,      {security, nobody, security}},
        // Part 3, 4.9.2
        Row{Thing::Settings,         over::encrypted,      {operators, admins, admins}},
        Row{Thing::SecuritySettings, over::encrypted,      {admins, security, nobody},
                                                           {operators, security, nobody}},
        // Part 20, 4.2 to 4.4
        Row{Thing::Files,            over::encrypted,      {readers | writers, nobody,
                                                            readers | writers}},
        Row{Thing::FileChanges,      over::encrypted,      {writers, nobody, writers}},
    };
    // clang-format on
}();

[[nodiscard]] constexpr const RightOfThing& right_of(Thing thing)
{
    return rights_of_things[static_cast<std::size_t>(thing)];
}

static_assert(rights_of_things.size() == static_cast<std::size_t>(Thing::Count));
static_assert([] {
    for (std::size_t i = 0; i < rights_of_things.size(); ++i) {
        if (rights_of_things[i].thing != static_cast<Thing>(i)) {
            return false;
        }
    }
    return true;
}());

/// Whom who::readers and who::writers are; others are the well-known roles.
struct NamedRoles {
    std::vector<NodeId> readers;
    std::vector<NodeId> writers;
};

/// What a node of this class has that is part of the thing. Variables that belong to a Method are
/// of class Method, with `is_argument`.
[[nodiscard]] model::NodeAccess access_of(Thing thing, NodeClass node_class,
                                          const NamedRoles& roles = {}, bool is_argument = false,
                                          Authorities authorities = Authorities::Standard);

/// Gives the thing's rights to the node, and to all below it those of the things that they are.
/// What a role may do beyond that stays, if it has a right; what else namespace 0 says goes.
void give_rights(model::AddressSpace& space, model::NodeIndex node, Thing thing,
                 Authorities authorities);

/// The same for all that namespace 0 and the administration's own nodes have; after those were
/// added.
void give_rights(model::AddressSpace& space, Authorities authorities);

} // namespace busbar::administration::detail
