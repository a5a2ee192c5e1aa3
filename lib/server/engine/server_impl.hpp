#pragma once

#include <string>
#include <string_view>

#include <busbar/server/server.hpp>

#include "core.hpp"
#include "peer_link.hpp"

namespace busbar::server {

struct Server::Impl : detail::Core {
    using Core::Core;

    /// Fails if the configuration needs a missing module.
    [[nodiscard]] Configured<void> check_modules(const ServerConfig& wanted) const;
    /// Returns why a peer cannot be accepted; empty if it can, for which another one may have been
    /// closed.
    [[nodiscard]] std::string find_obstacle(std::string_view peer_address);
    /// Logs the reason.
    void refuse(std::string_view peer_address, std::string why);
    /// Makes room by closing the oldest connection that has no session (Part 4, 5.6.2.1), of the
    /// network that has most of these.
    [[nodiscard]] bool make_place(std::string_view peer_address);
    void expire_sessions(TimePoint now);
    /// Returns false if it threw.
    bool survive(std::string_view what, FunctionRef<void()> work);
    [[nodiscard]] TimePoint first_due();
    /// Enters the state, adapts the sources, and notifies clients by an event.
    void enter(ServerState state, std::string_view reason, DateTime return_time);
    /// Also replaces a countdown.
    void begin_shutdown(TimePoint now, std::string_view reason, std::chrono::milliseconds delay,
                        DateTime return_time);
    /// Returns whether it shuts down and nothing can cancel that.
    [[nodiscard]] bool is_ending() const { return is_shutting_down() && countdown_heir == nullptr; }
    void finish_shutdown();
    [[nodiscard]] Configured<void> check_change(const ServerConfig& wanted) const;
    void close_old_channels();
    void close_untrusted_channels();
    /// Ends sessions whose endpoint does not exist any more.
    void end_homeless_sessions();
    /// Ends sessions one by one, since each may end others as well.
    std::size_t end_sessions(StatusCode status, bool deletes_subscriptions,
                             FunctionRef<bool(const detail::Session&)> which);
};

} // namespace busbar::server
