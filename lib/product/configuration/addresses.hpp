#pragma once

#include <string>
#include <vector>

#include "config.hpp"

namespace busbar::product {

/// How this machine calls itself; "localhost" if it does not say.
[[nodiscard]] std::string machine_name();

/// Whether the configured `address` is all that the machine has: "", 0.0.0.0 or ::.
[[nodiscard]] bool is_every_address(const std::string& address);

/// The host of the URL that clients get which used none that is known: the configured address, and
/// the machine's name where that is every address.
[[nodiscard]] std::string default_host(const ControllerConfig& config, const std::string& machine);

/// The addresses of this machine's network interfaces that are up, in the system's order; nothing
/// if it does not say.
[[nodiscard]] std::vector<std::string> interface_addresses();

/// How many addresses of interfaces a controller that listens to all of them makes known.
constexpr std::size_t max_interface_addresses = 16;

/// What the certificate names and endpoints are returned with, if a client used it: the default
/// host, what `host_names` adds, the machine's name, where it listens to every address those of the
/// `interfaces`, and its own names for itself where it listens to them. Each once. Addresses that
/// only the same link reaches (169.254.0.0/16, fe80::/10) are left out if there are others.
[[nodiscard]] std::vector<std::string> known_hosts(const ControllerConfig& config,
                                                   const std::string& machine,
                                                   const std::vector<std::string>& interfaces);

/// Of such hosts the first address that other machines may use; else the first address, or the
/// first host.
[[nodiscard]] std::string address_of(const std::vector<std::string>& hosts);

} // namespace busbar::product
