#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::server {

/// The size of namespace 0 (BUSBAR_NAMESPACE0).
enum class Namespace0Size : std::uint8_t { None, Micro, Embedded, Standard, Full };

/// The facts that decide which conformance units of Part 7 a server meets: what is compiled in,
/// configured and limited. By default there is nothing.
struct ConformanceFacts {
    Namespace0Size namespace0{Namespace0Size::None};

    // Modules of the server.

    bool methods{false};
    bool events{false};
    bool node_management{false};
    bool diagnostics{false};
    bool triggering{false};
    bool transfer{false};
    bool audit{false};
    /// RoleSet with Methods.
    bool roles{false};
    /// ServerConfiguration with Methods.
    bool push{false};
    /// UserManagement with Methods.
    bool user_management{false};
    /// RequestServerStateChange.
    bool state_change{false};

    // Transports, and functions of the program around it.

    bool tcp{false};
    bool reverse_connect{false};
    bool discovery{false};
    /// The program uses the client layer.
    bool client{false};

    // Kinds of users that some endpoint accepts.

    bool users_anonymous{false};
    bool users_password{false};
    bool users_certificate{false};
    bool users_issued{false};
    /// Passwords or tokens may be sent in clear text.
    bool users_unencrypted{false};

    // Policies of some endpoint.

    bool policy_none{false};
    bool policy_basic256sha256{false};
    bool policy_aes128{false};
    bool policy_aes256{false};

    // Capacities for all clients together of the largest profile that fits the sessions.

    std::size_t sessions{0};
    std::size_t channels{0};
    /// Subscriptions of one session.
    std::size_t subscriptions{0};
    /// Items of one Subscription.
    std::size_t items{0};
    /// Publish requests of one session.
    std::size_t publish{0};
    /// Values of one item.
    std::size_t queue{0};
    /// Continuation points of one session.
    std::size_t continuation_points{0};

    /// Numbers of the types of namespace 0 that have instances, including instances of subtypes, in
    /// ascending order.
    std::vector<std::uint32_t> instance_types;
    /// Names of units whose requirements on the application, its documentation or its host are met.
    std::vector<std::string> declared_units;
};

/// A unit that is not met, and the reason.
struct UnitLack {
    /// Static.
    std::string_view unit;
    /// The unmet requirement, as in schemas/conformance.csv, or "has no test". Static.
    std::string_view need;
};

/// A profile, and what is missing for a claim.
struct ProfileAssessment {
    /// The name as in schemas/profiles.csv: "Standard2017Server". Static.
    std::string_view name;
    /// Static.
    std::string_view uri;
    /// A profile of clients, which no server claims.
    bool is_client{false};
    /// All mandatory units of the profile and of those that it includes are met and have tests.
    bool is_claimed{false};
    /// The units that are not met, each once; empty if the profile is claimed.
    std::vector<UnitLack> lacks;
};

/// The profiles and units that a server may claim, and what is missing for others: clients read it
/// as ServerProfileArray and ConformanceUnits (Part 5, 6.3.2).
struct Conformance {
    /// All known profiles, in the order of their names.
    std::vector<ProfileAssessment> profiles;
    /// Names of the units that are met and have tests, in the order of their names, without those
    /// of clients. Static.
    std::vector<std::string_view> units;
    /// Names of units of clients likewise. Static.
    std::vector<std::string_view> client_units;

    /// Null if no profile has that name.
    [[nodiscard]] BUSBAR_API const ProfileAssessment* find(std::string_view name) const;
};

/// Compares each profile with the requirements of Part 7 (schemas/profiles.csv,
/// schemas/conformance.csv).
[[nodiscard]] BUSBAR_API Conformance assess(const ConformanceFacts& facts);
/// Assesses a server that names these units as its own; missing ones have the need "does not name".
[[nodiscard]] BUSBAR_API Conformance assess_units(std::span<const std::string_view> units);

} // namespace busbar::server
