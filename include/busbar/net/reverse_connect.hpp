#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>

namespace busbar::net {

/// Clients that cannot reach the server, so that it connects to them (Part 6, 7.1.2.6).
///
/// Each has one connection that it does not use yet, and may leave it so for ever: no handshake
/// timeout of the server counts before the client's first byte. What ends such a connection is the
/// client, who closes or refuses it; keep-alive of TCP, which finds out within two minutes that the
/// client's machine or the network has gone; and a server without place for others. It is then made
/// anew as after any failure.
struct ReverseConnectConfig {
    /// opc.tcp://host:port of each client's listener.
    std::vector<std::string> client_urls;
    /// For TCP's connection.
    Duration connect_timeout{std::chrono::seconds{10}};
    /// After a failure it is tried again after `first_delay`, then twice as long each time, up to
    /// `longest_delay`, each shortened at random by up to a fifth.
    Duration first_delay{std::chrono::seconds{1}};
    Duration longest_delay{std::chrono::seconds{30}};
    /// Connections that one client uses at the same time; so many more are not offered.
    std::size_t max_connections{10};
};

} // namespace busbar::net
