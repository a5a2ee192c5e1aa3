#pragma once

#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/jumping_clock.hpp>

namespace busbar::harness {

/// What the certificate of a test says. The default is right for a server of its name and for a
/// client; a test of a wrong certificate changes what is to be wrong.
struct IdentityOptions {
    std::string name{"server"};
    /// Empty: "urn:busbar:harness:<name>", as open_server_config() and open_connection_config()
    /// have it.
    std::string application_uri{};
    /// Empty: the name.
    std::vector<std::string> host_names{};
    /// 30 days before the world begins; over in the past with a few days only.
    DateTime valid_from{first_day.ticks - 30 * 86'400 * DateTime::ticks_per_second};
    std::uint32_t valid_days{365};
    std::uint32_t key_bits{2'048};
};

/// A new key and a self-signed certificate for it. Keys do not depend on the seed of a world and
/// take a tenth of a second: tests make one and share it. Errors are those of
/// crypto::create_self_signed.
[[nodiscard]] BUSBAR_API Result<channel::ApplicationIdentity>
make_identity(const IdentityOptions& options);

} // namespace busbar::harness
