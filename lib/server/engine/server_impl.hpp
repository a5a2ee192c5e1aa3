#pragma once

#include <string>
#include <string_view>

#include <busbar/server/server.hpp>

#include "core.hpp"
#include "peer_link.hpp"

namespace busbar::server {

struct Server::Impl : detail::Core {
    using Core::Core;

    /// Refused if the configuration asks for what no module has.
    [[nodiscard]] Configured<void> check_modules(const ServerConfig& wanted) const;
    /// Why a peer cannot be taken; nothing if it can, for which another may have been closed.
    [[nodiscard]] std::string find_obstacle(std::string_view peer_address);
    /// Tells the log why.
    void refuse(std::string_view peer_address, std::string why);
    /// Makes place by closing the oldest connection that has no session (Part 4, 5.6.2.1), of the
    /// network that has most such.
    [[nodiscard]] bool make_place(std::string_view peer_address);
    void expire_sessions(TimePoint now);
    /// False if it threw.
    bool survive(std::string_view what, FunctionRef<void()> work);
    [[nodiscard]] TimePoint first_due();
    /// Is in the state, with the sources as it wants them, and tells clients by an event.
    void enter(ServerState state, std::string_view reason, DateTime return_time);
    /// Also in place of a countdown.
    void begin_shutdown(TimePoint now, std::string_view reason, std::chrono::milliseconds delay,
                        DateTime return_time);
    /// Whether it shuts down and nothing can take that back.
    [[nodiscard]] bool is_ending() const { return is_shutting_down() && countdown_heir == nullptr; }
    void finish_shutdown();
    [[nodiscard]] Configured<void> check_change(const ServerConfig& wanted) const;
    void close_old_channels();
    void close_untrusted_channels();
    /// Sessions over endpoints that there are no more.
    void end_homeless_sessions();
    /// Ends sessions one by one, since each may take others along.
    std::size_t end_sessions(StatusCode status, bool deletes_subscriptions,
                             FunctionRef<bool(const detail::Session&)> which);
};

} // namespace busbar::server
