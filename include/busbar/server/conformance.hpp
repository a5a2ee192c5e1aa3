#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>

namespace busbar::server {

/// How much of namespace 0 there is (BUSBAR_NAMESPACE0).
enum class Namespace0Size : std::uint8_t { None, Micro, Embedded, Standard, Full };

/// What decides which conformance units of Part 7 a server meets: what is compiled in, what is
/// configured and what is limited. By default there is nothing.
struct ConformanceFacts {
    Namespace0Size namespace0{Namespace0Size::None};

    // Modules that the server has.

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

    // What it is reached by, and what the program around it does.

    bool tcp{false};
    bool reverse_connect{false};
    bool discovery{false};
    /// The client layer takes part in the program.
    bool client{false};

    // Users that some endpoint lets in.

    bool users_anonymous{false};
    bool users_password{false};
    bool users_certificate{false};
    bool users_issued{false};
    /// Passwords or tokens may come in clear text.
    bool users_unencrypted{false};

    // Policies that some endpoint has.

    bool policy_none{false};
    bool policy_basic256sha256{false};
    bool policy_aes128{false};
    bool policy_aes256{false};

    // What all clients of the largest profile that fits the sessions may have at a time.

    std::size_t sessions{0};
    std::size_t channels{0};
    /// Of one session.
    std::size_t subscriptions{0};
    /// Of one Subscription.
    std::size_t items{0};
    /// Publish requests of one session.
    std::size_t publish{0};
    /// Values of one item.
    std::size_t queue{0};
    /// Of one session.
    std::size_t continuation_points{0};

    /// Numbers of the types of namespace 0, in ascending order, of which there are instances, those
    /// of their subtypes included.
    std::vector<std::uint32_t> instance_types;
    /// Names of units that ask for something of the application, its documentation or its host,
    /// which is there.
    std::vector<std::string> declared_units;
};

/// A unit that is not met, and why.
struct UnitLack {
    /// Static.
    std::string_view unit;
    /// The need that is not met, as schemas/conformance.csv has it, or "has no test". Static.
    std::string_view need;
};

struct ProfileAssessment {
    /// As schemas/profiles.csv has it: "Standard2017Server". Static.
    std::string_view name;
    /// Static.
    std::string_view uri;
    /// A profile of clients, which no server claims.
    bool is_client{false};
    /// All mandatory units of the profile and of those that it includes are met and have tests.
    bool is_claimed{false};
    /// Those that are not, each once; empty if the profile is claimed.
    std::vector<UnitLack> lacks;
};

/// What a server may say of itself, and what it would take to say more: clients read it as
/// ServerProfileArray and ConformanceUnits (Part 5, 6.3.2).
struct Conformance {
    /// All profiles that are known, in the order of their names.
    std::vector<ProfileAssessment> profiles;
    /// Names of the units that are met and have tests, in the order of their names; without those
    /// of clients. Static.
    std::vector<std::string_view> units;
    /// The same of clients. Static.
    std::vector<std::string_view> client_units;

    /// Null if no profile has that name.
    [[nodiscard]] BUSBAR_API const ProfileAssessment* find(std::string_view name) const;
};

/// Looks each profile up in what Part 7 asks for (schemas/profiles.csv, schemas/conformance.csv).
[[nodiscard]] BUSBAR_API Conformance assess(const ConformanceFacts& facts);
/// What a server meets that names these units as its own; what it lacks it "does not name".
[[nodiscard]] BUSBAR_API Conformance assess_units(std::span<const std::string_view> units);

} // namespace busbar::server
