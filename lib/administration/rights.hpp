#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <busbar/administration/authorities.hpp>
#include <busbar/model/address_space.hpp>

/// The rights of each role to each part of the administration, and the channels that they need, in
/// one table. The nodes get their RolePermissions and AccessRestrictions from it, which the server
/// enforces.
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
/// Roles that the program defines, see NamedRoles.
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
inline constexpr std::uint16_t encrypted = 3;      // includes signing
inline constexpr std::uint16_t signed_session = 5; // requires a session
} // namespace over

/// The things that rights apply to.
enum class Thing : std::uint8_t {
    StateChange,      // RequestServerStateChange
    ServerStatus,     // ServerDiagnosticsSummary
    ServiceStatus,    // the Object "Status", see StatusFact
    Roles,            // the RoleSet and its roles
    RoleRules,        // what a role consists of, AddRole and RemoveRole
    UserManagement,   // the Object, and the rules for passwords
    Users,            // the list, and the Methods that change it
    OwnPassword,      // ChangePassword
    ServerFacts,      // ServerConfiguration and its Variables
    TrustLists,       // groups, trust lists, rejected certificates, and transactions as they are
    TrustListChanges, // the Methods that change a trust list
    TransactionEnds,  // ApplyChanges and CancelChanges
    OwnCertificate,   // the Methods that change the server's certificate or disclose its key
    Reset,            // ResetToServerDefaults
    Settings,         // the Object, its Method, and all settings except those of security
    SecuritySettings, // Setting::is_security
    Files,            // files and folders, and the Methods that read them
    FileChanges,      // the Methods that change files
    Count
};

/// The rights to see nodes (Browse and Read), to write Variables, and to call Methods, including
/// Methods of an Object.
struct Rights {
    Roles see;
    Roles write;
    Roles call;
};

/// `five_levels` applies with Authorities::FiveLevels.
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

/// The roles that the bits readers and writers stand for; other bits are well-known roles.
struct NamedRoles {
    std::vector<NodeId> readers;
    std::vector<NodeId> writers;
};

/// Returns the access rights of a node of this class that belongs to the thing. Variables of a
/// Method have the class Method and `is_argument`.
[[nodiscard]] model::NodeAccess access_of(Thing thing, NodeClass node_class,
                                          const NamedRoles& roles = {}, bool is_argument = false,
                                          Authorities authorities = Authorities::Standard);

/// Gives the node the rights of the thing, and the nodes below it those of the things that they
/// belong to. A role that has any of these rights keeps its other permissions; all other
/// permissions in namespace 0 are removed.
void give_rights(model::AddressSpace& space, model::NodeIndex node, Thing thing,
                 Authorities authorities);

/// The same for all nodes of administration in namespace 0 and the server's namespace; call it
/// after these were added.
void give_rights(model::AddressSpace& space, Authorities authorities);

} // namespace busbar::administration::detail
