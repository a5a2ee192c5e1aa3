#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/model/node.hpp>

namespace busbar::administration {

/// The rights of roles to the administration, in addition to those of namespace 0.
enum class Authorities : std::uint8_t {
    /// No additional rights: only SecurityAdmin and ConfigureAdmin administer and read.
    Standard,
    /// The five authorities of NJ and NX controllers (W588, 8-1), each of which
    /// includes the previous ones: Operator, Maintainer and Designer see certificates, revocation
    /// lists, settings and the service's status, Maintainer and Designer clear logs, Designer shuts
    /// the server down.
    FiveLevels,
};

/// One of the five authorities, with the well-known roles (Part 3, 4.9.2) that have it.
enum class Authority : std::uint8_t {
    Observer,      // Observer
    Operator,      // Operator
    Maintainer,    // Supervisor
    Designer,      // Engineer
    Administrator, // SecurityAdmin, ConfigureAdmin
};

/// Reads "standard" or "five levels"; nothing for other texts.
[[nodiscard]] BUSBAR_API std::optional<Authorities> find_authorities(std::string_view name);

/// Returns the access rules of a node that `reads` and higher authorities see and read, and that
/// `acts` and higher ones write and call, over encrypted channels.
[[nodiscard]] BUSBAR_API model::NodeAccess access_from(Authority reads, Authority acts);

} // namespace busbar::administration
