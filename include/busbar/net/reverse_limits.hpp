#pragma once

#include <chrono>
#include <cstddef>

#include <busbar/core/clock.hpp>

namespace busbar::net {

/// Limits of what strangers may make a listener hold.
struct ReverseListenerLimits {
    /// Connections that wait for their ReverseHello or for a client that needs them. When there is
    /// one more, the oldest is closed.
    std::size_t max_waiting{32};
    /// How long the ReverseHello may take (Part 6, 7.1.3: never more than two minutes).
    Duration hello_timeout{std::chrono::seconds{5}};
    /// How long a connection is kept for a client that does not need it yet. The server replaces
    /// each that is closed, so that a short time keeps both sides busy; meanwhile keep-alive of TCP
    /// finds out, within two minutes, if the server is gone.
    Duration hold_time{std::chrono::hours{1}};
};

} // namespace busbar::net
