#pragma once

#include <cstddef>

#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>

namespace busbar::net {

/// Limits of what unknown peers may make a listener hold.
struct ReverseListenerLimits {
    /// Connections that wait for their ReverseHello or for a client that needs them. For one more,
    /// the oldest is closed.
    std::size_t max_waiting{32};
    /// Limits the time until the ReverseHello (Part 6, 7.1.3: never more than two minutes).
    Duration hello_timeout{std::chrono::seconds{5}};
    /// Maximum time that a connection is kept for a client that does not need it yet. The server
    /// replaces each closed one, so that a short time keeps both sides busy; meanwhile keep-alive
    /// of TCP finds out, within two minutes, if the server is gone.
    Duration hold_time{std::chrono::hours{1}};
};

} // namespace busbar::net
