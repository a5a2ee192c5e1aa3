#pragma once

#include <string>
#include <vector>

#include "config.hpp"

namespace busbar::product {

/// The machine's name; "localhost" if the system gives none.
[[nodiscard]] std::string machine_name();

/// Tells whether the configured `address` means all addresses of the machine: "", 0.0.0.0 or ::.
[[nodiscard]] bool is_every_address(const std::string& address);

/// The host of the URL for clients that used an unknown one: the configured address, or the
/// machine's name if that is every address.
[[nodiscard]] std::string default_host(const ControllerConfig& config, const std::string& machine);

/// The addresses of this machine's active network interfaces, in the system's order; nothing if the
/// system does not give them.
[[nodiscard]] std::vector<std::string> interface_addresses();

/// Maximum number of interface addresses that a controller publishes if it listens to all.
constexpr std::size_t max_interface_addresses = 16;

/// The hosts for the certificate, and for the endpoints of clients that used one of them: the
/// default host, `host_names`, the machine's name, the addresses of `interfaces` if it listens to
/// every address, and its loopback names if it listens to them. Each occurs once. Link-local
/// addresses (169.254.0.0/16, fe80::/10) are left out if there are others.
[[nodiscard]] std::vector<std::string> known_hosts(const ControllerConfig& config,
                                                   const std::string& machine,
                                                   const std::vector<std::string>& interfaces);

/// Returns the first address among these hosts that other machines can use; otherwise the first
/// address or the first host.
[[nodiscard]] std::string address_of(const std::vector<std::string>& hosts);

} // namespace busbar::product
