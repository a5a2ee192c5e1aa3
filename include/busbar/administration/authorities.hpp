#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/model/node.hpp>

namespace busbar::administration {

/// Who may do what of the administration, beyond what namespace 0 says.
enum class Authorities : std::uint8_t {
    /// Nothing is beyond it: SecurityAdmin and ConfigureAdmin administer, nobody else looks.
    Standard,
    /// The five authorities of NJ and NX controllers (seed 000, 8-1), which build on each other:
    /// Operator, Maintainer and Designer see certificates, revocation lists, settings and the
    /// service's status, Maintainer and Designer clear logs, Designer shuts the server down.
    FiveLevels,
};

/// One of the five, and the well-known roles (Part 3, 4.9.2) that have it.
enum class Authority : std::uint8_t {
    Observer,      // Observer
    Operator,      // Operator
    Maintainer,    // Supervisor
    Designer,      // Engineer
    Administrator, // SecurityAdmin, ConfigureAdmin
};

/// "standard" or "five levels"; nothing for other texts.
[[nodiscard]] BUSBAR_API std::optional<Authorities> find_authorities(std::string_view name);

/// A node that `reads` and those above see and read, and that `acts` and those above write and
/// call, over encrypted channels.
[[nodiscard]] BUSBAR_API model::NodeAccess access_from(Authority reads, Authority acts);

} // namespace busbar::administration
