#pragma once

#include <string>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/harness/jumping_clock.hpp>

namespace busbar::harness {

/// The content of a test's certificate. The default is right for a server of its name and for a
/// client; a test of a wrong certificate changes the part that shall be wrong.
struct IdentityOptions {
    std::string name{"server"};
    /// If empty, "urn:busbar:harness:<name>", as in open_server_config() and
    /// open_connection_config().
    std::string application_uri{};
    /// If empty, the name.
    std::vector<std::string> host_names{};
    /// 30 days before the world begins; a validity of a few days makes it an expired certificate.
    DateTime valid_from{first_day.ticks - std::int64_t{30} * 86'400 * DateTime::ticks_per_second};
    std::uint32_t valid_days{365};
    std::uint32_t key_bits{2'048};
};

/// Creates a new key and a self-signed certificate for it. Keys do not depend on the seed of a
/// world and take a tenth of a second: tests create one and share it. Errors are those of
/// crypto::create_self_signed.
[[nodiscard]] BUSBAR_API Result<channel::ApplicationIdentity>
make_identity(const IdentityOptions& options);

/// Return an identity of the name "server" or "client", which all tests of the process share. It is
/// made when it is first asked for, from any thread. Throw std::runtime_error if that fails.
[[nodiscard]] BUSBAR_API const channel::ApplicationIdentity& default_server_identity();
[[nodiscard]] BUSBAR_API const channel::ApplicationIdentity& default_client_identity();

} // namespace busbar::harness
