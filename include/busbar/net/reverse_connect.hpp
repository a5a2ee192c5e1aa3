#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>

namespace busbar::net {

/// Clients that cannot reach the server, so that the server connects to them (Part 6, 7.1.2.6).
///
/// Each has one connection that it does not use yet, and may leave it like that for ever: no
/// handshake timeout of the server begins before the client's first byte. Such a connection ends
/// when the client closes or refuses it; when keep-alive of TCP finds out, within two minutes, that
/// the client's machine or the network is gone; and when a server has no room for others. It is
/// then opened again, as after any failure.
struct ReverseConnectConfig {
    /// opc.tcp://host:port of each client's listener.
    std::vector<std::string> client_urls;
    /// Limits the time for opening the TCP connection.
    Duration connect_timeout{std::chrono::seconds{10}};
    /// After a failure it tries again after `first_delay`, then each time after twice the delay, up
    /// to `longest_delay`, each shortened at random by up to a fifth.
    Duration first_delay{std::chrono::seconds{1}};
    Duration longest_delay{std::chrono::seconds{30}};
    /// Maximum number of connections that one client may use at the same time; beyond it no further
    /// one is offered.
    std::size_t max_connections{10};
};

} // namespace busbar::net
